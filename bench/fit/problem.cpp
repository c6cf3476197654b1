#include "fit/problem.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <slom/initialize.hpp>
#include <slom/io/bal.hpp>
#include <slom/io/g2o.hpp>
#include <slom/io/number.hpp>
#include <slom/io/pose_graph_model.hpp>

#include "fit/generate_graph.hpp"
#include "fit/generate_scene.hpp"
#include "support/bad_input.hpp"

namespace slom::bench {

namespace {

using io::Pose2;
using io::Pose3;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

/// Returns whether a file holds a graph. Files of pose graphs begin with a tag, those of scenes with a number.
bool holdsGraph(const std::string& file) {
  if (file.ends_with(".bz2")) return false;
  std::ifstream stream(file);
  char first = 0;
  stream >> first;
  return std::isalpha(static_cast<unsigned char>(first)) != 0 || first == '#';
}

template <class Pose>
void setDeviations(io::PoseGraph<Pose>& graph, const std::vector<double>& deviations) {
  constexpr int dof = io::dof<Pose>;
  if (deviations.size() != dof) {
    throw BadInput(fmt::format("--deviations: {} numbers for edges of {} degrees of freedom in {}",
                               deviations.size(), dof, graph.file));
  }
  const Eigen::Map<const Eigen::Matrix<double, dof, 1>> sigma(deviations.data());
  for (auto& edge : graph.edges) edge.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

using initialize::Start;
constexpr std::pair<const char*, Start> starts[] = {{"file", Start::given},
                                                    {"odometry", Start::odometry},
                                                    {"spanning-tree", Start::spanning_tree},
                                                    {"chordal", Start::chordal},
                                                    {"build-up", Start::build_up}};

/// Parses the name of a start; none: the start with the lowest RSS.
std::optional<Start> parseStart(const std::string& text) {
  if (text == "auto") return std::nullopt;
  for (const auto& [name, start] : starts) {
    if (text == name) return start;
  }
  throw BadInput(fmt::format(
      "--init {}: unknown start; give auto, file, odometry, spanning-tree, chordal or build-up", text));
}

template <class Pose>
Start chooseStart(io::PoseGraph<Pose>& graph) {
  std::vector<Start> candidates{Start::odometry, Start::spanning_tree, Start::chordal};
  if (graph.has_vertices) candidates.insert(candidates.begin(), Start::given);
  if (!graph.sightings.empty()) candidates.push_back(Start::build_up);
  const io::PoseGraphModel model;
  const auto find = [&](io::PoseGraph<Pose>& g, Start start) { initialize::findStart(g, start, model); };
  return initialize::chooseStart(graph, candidates, find, model).start;
}

/// Holds the first pose if the file has no FIX lines, and finds start values. Returns the name of the start.
template <class Pose>
std::string prepare(io::PoseGraph<Pose>& graph, const ProblemOptions& options) {
  if (!options.deviations.empty()) setDeviations(graph, options.deviations);
  if (!graph.has_fix_lines) graph.poses.front().fixed = true;
  std::optional<Start> start = !options.init.empty() ? parseStart(options.init)
                               : graph.has_vertices  ? Start::given
                                                     : Start::spanning_tree;
  if (start) {
    initialize::findStart(graph, *start, io::PoseGraphModel());
  } else {
    start = chooseStart(graph);
  }
  return std::find_if(std::begin(starts), std::end(starts),
                      [&](const auto& named) { return named.second == *start; })
      ->first;
}

Problem readFile(const std::string& file, const ProblemOptions& options) {
  Problem problem;
  problem.name = std::filesystem::path(file).filename().string();
  problem.name.erase(std::min(problem.name.size(), problem.name.find('.')));
  if (!holdsGraph(file)) {
    problem.data = io::readScene(file);
    problem.start = "file";
    return problem;
  }
  std::visit(
      [&](auto graph) {
        problem.start = prepare(graph, options);
        problem.data = std::move(graph);
      },
      io::readPoseGraph(file));
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

/// Generates a problem. Returns false if `source` names no generator.
bool generate(const std::string& source, Problem& problem) {
  const std::size_t colon = source.find(':');
  if (colon == std::string::npos) return false;
  for (const Generator& generator : generators) {
    if (source.substr(0, colon) != generator.name) continue;
    int size = 0;
    if (!io::parseNumber(source.substr(colon + 1), size) || size < 100) {
      throw BadInput(
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
      Overloaded{[](const io::Scene& scene) { return scene.cameras.size() + scene.points.size(); },
                 [](const auto& graph) { return graph.poses.size() + graph.landmarks.size(); }},
      data);
}

std::size_t Problem::measurements() const {
  return std::visit(Overloaded{[](const io::Scene& scene) { return scene.observations.size(); },
                               [](const auto& graph) { return graph.edges.size() + graph.sightings.size(); }},
                    data);
}

Problem loadProblem(const std::string& source, const ProblemOptions& options) {
  Problem problem;
  if (!generate(source, problem)) problem = readFile(source, options);
  problem.kind = std::visit(Overloaded{[](const io::Scene&) { return "bundle"; },
                                       [](const io::PoseGraph<Pose2>&) { return "graph in the plane"; },
                                       [](const io::PoseGraph<Pose3>&) { return "graph in space"; }},
                            problem.data);
  return problem;
}

}  // namespace slom::bench
