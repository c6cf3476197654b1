#include "fit/problem.hpp"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "bundle/input/read.hpp"
#include "error.hpp"
#include "fit/generate_graph.hpp"
#include "fit/generate_scene.hpp"
#include "graph/input/information.hpp"
#include "graph/input/read.hpp"
#include "graph/start/gauge.hpp"
#include "graph/start/start.hpp"
#include "text.hpp"

namespace slom::bench {

namespace {

using app::UserError;
using app::graph::Pose2;
using app::graph::Pose3;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};

/// Files of pose graphs begin with a tag, those of scenes with a number.
bool holdsGraph(const std::string& file) {
  if (file.ends_with(".bz2")) return false;
  std::ifstream stream(file);
  char first = 0;
  stream >> first;
  return std::isalpha(static_cast<unsigned char>(first)) != 0 || first == '#';
}

template <class Pose>
void setDeviations(app::graph::PoseGraph<Pose>& graph, const std::vector<double>& deviations) {
  constexpr int dof = app::graph::dof<Pose>;
  if (deviations.size() != dof) {
    throw UserError(fmt::format("--deviations: {} numbers for edges of {} degrees of freedom in {}",
                                deviations.size(), dof, graph.file));
  }
  const Eigen::Map<const Eigen::Matrix<double, dof, 1>> sigma(deviations.data());
  for (auto& edge : graph.edges) edge.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

template <class Pose>
std::string prepare(app::graph::PoseGraph<Pose>& graph, const ProblemOptions& options) {
  if (!options.deviations.empty()) setDeviations(graph, options.deviations);
  app::graph::checkInformation(graph, false);
  app::graph::holdGauge(graph, false);
  using app::graph::Start;
  const std::optional<Start> start = !options.init.empty() ? app::graph::parseStart(options.init)
                                     : graph.has_vertices  ? Start::given
                                                           : Start::spanning_tree;
  return app::graph::optionOf(app::graph::findStart(graph, start, {}).start);
}

Problem readFile(const std::string& file, const ProblemOptions& options) {
  Problem problem;
  problem.name = std::filesystem::path(file).filename().string();
  problem.name.erase(std::min(problem.name.size(), problem.name.find('.')));
  if (!holdsGraph(file)) {
    problem.data = app::bundle::readScene(file);
    problem.start = "file";
    return problem;
  }
  std::visit(
      [&](auto graph) {
        problem.start = prepare(graph, options);
        problem.data = std::move(graph);
      },
      app::graph::readPoseGraph(file));
  return problem;
}

struct Generator {
  const char* name;
  AnyProblem (*make)(int size);
};
constexpr Generator generators[] = {
    {"grid2d", [](int size) -> AnyProblem { return generateLattice<Pose2>(size, 2); }},
    {"sheet", [](int size) -> AnyProblem { return generateLattice<Pose3>(size, 2); }},
    {"grid3d", [](int size) -> AnyProblem { return generateLattice<Pose3>(size, 3); }},
    {"scene", [](int size) -> AnyProblem { return generateScene(size); }},
};

/// False when `source` names no generator.
bool generate(const std::string& source, Problem& problem) {
  const std::size_t colon = source.find(':');
  if (colon == std::string::npos) return false;
  for (const Generator& generator : generators) {
    if (source.substr(0, colon) != generator.name) continue;
    int size = 0;
    if (!app::parseNumber(source.substr(colon + 1), size) || size < 100) {
      throw UserError(
          fmt::format("{}: write {}:SIZE, SIZE a whole number from 100 on", source, generator.name));
    }
    problem.name = source;
    problem.is_generated = true;
    problem.start = "truth + noise";
    problem.data = generator.make(size);
    return true;
  }
  return false;
}

}  // namespace

std::size_t Problem::variables() const {
  return std::visit(
      Overloaded{[](const app::bundle::Scene& scene) { return scene.cameras.size() + scene.points.size(); },
                 [](const auto& graph) { return graph.poses.size() + graph.landmarks.size(); }},
      data);
}

std::size_t Problem::measurements() const {
  return std::visit(Overloaded{[](const app::bundle::Scene& scene) { return scene.observations.size(); },
                               [](const auto& graph) { return graph.edges.size() + graph.sightings.size(); }},
                    data);
}

Problem loadProblem(const std::string& source, const ProblemOptions& options) {
  Problem problem;
  if (!generate(source, problem)) problem = readFile(source, options);
  problem.kind =
      std::visit(Overloaded{[](const app::bundle::Scene&) { return "bundle"; },
                            [](const app::graph::PoseGraph<Pose2>&) { return "graph in the plane"; },
                            [](const app::graph::PoseGraph<Pose3>&) { return "graph in space"; }},
                 problem.data);
  return problem;
}

}  // namespace slom::bench
