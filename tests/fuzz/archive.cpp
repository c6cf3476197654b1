// Saved problems of the kinds of slom replay with poses, and of tapes. A loaded problem can be saved and loaded again,
// with the same text, and a step of its fit can be taken. Checksums of tapes are corrected first, so that hostile tapes
// come to their checks.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <slom/archive.hpp>

#include "fuzz/target.hpp"
#include "replay/kinds.hpp"

namespace slom::fuzz {
namespace {

/// Returns the text with the checksums that its tapes have. `load` names them one after the other.
template <class Load>
std::string withChecksums(const std::string& text, const Load& load) {
  std::vector<std::string> lines;
  std::istringstream is(text);
  for (std::string line; std::getline(is, line);) lines.push_back(line);
  const auto joined = [&] {
    std::string all;
    for (const std::string& line : lines) all += line + "\n";
    return all;
  };
  for (int tapes = 0; tapes < 5; ++tapes) {
    try {
      load(joined());
      return joined();
    } catch (const mtk::Error& error) {
      const std::string_view sentence = error.sentence(), before = "have the checksum ";
      const std::size_t at = sentence.find(before), line = std::strtoul(sentence.data() + 5, nullptr, 10);
      if (at == std::string_view::npos || line == 0 || line > lines.size()) return joined();
      lines[line - 1] = "checksum " + std::string(sentence.substr(at + before.size(), 16));
    }
  }
  return joined();
}

}  // namespace
}  // namespace slom::fuzz

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
  if (!accepted([&] { saved = save(load(withChecksums(std::string(input), load))); })) return;
  StoredProblem problem = load(saved);
  accepted([&] { problem.estimator.residuals(); });
  accepted([&] { problem.estimator.optimizeStep(); });
  std::string again;
  require(accepted([&] { again = save(load(saved)); }), "a saved problem is refused");
  require(std::count(again.begin(), again.end(), '\n') == std::count(saved.begin(), saved.end(), '\n'),
          "a saved problem loses lines");
}
