// Saved problems of the kinds of slom replay with poses, and of tapes. A loaded problem can be saved and loaded again,
// with the same text, and a step of its fit can be taken.
#include <algorithm>
#include <sstream>

#include <slom/archive.hpp>

#include "fuzz/target.hpp"
#include "replay/kinds.hpp"

SLOM_FUZZ_TARGET(archive) {
  static const Archive archive = [] {
    Archive all;
    app::replay::addPoseKinds(all);
    return all;
  }();
  const auto load = [&](const std::string& text) {
    std::istringstream is(text);
    return archive.load(is, "FILE");
  };
  const auto save = [&](const StoredProblem& problem) {
    std::ostringstream os;
    archive.save(problem.estimator, os);
    return os.str();
  };
  std::string saved;
  if (!accepted([&] { saved = save(load(std::string(input))); })) return;
  StoredProblem problem = load(saved);
  accepted([&] { problem.estimator.residuals(); });
  accepted([&] { problem.estimator.optimizeStep(); });
  std::string again;
  require(accepted([&] { again = save(load(saved)); }), "a saved problem is refused");
  require(std::count(again.begin(), again.end(), '\n') == std::count(saved.begin(), saved.end(), '\n'),
          "a saved problem loses lines");
}
