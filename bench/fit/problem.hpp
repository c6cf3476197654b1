/// A problem to fit: a pose graph or a scene, from a file or generated.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <slom/io/pose_graph.hpp>
#include <slom/io/scene.hpp>

namespace slom::bench {

using AnyProblem = std::variant<io::PoseGraph<io::Pose2>, io::PoseGraph<io::Pose3>, io::Scene>;

struct Problem {
  std::string name;
  bool is_generated = false;
  std::string kind;   ///< `graph in the plane`, `graph in space` or `bundle`
  std::string start;  ///< description of the start, in a few words
  AnyProblem data;

  bool isGraph() const { return data.index() < 2; }
  std::size_t variables() const;
  std::size_t measurements() const;
};

struct ProblemOptions {
  /// As `slom graph --init`, but odometry follows the order of the file. Empty: the file's vertices, or a spanning tree
  /// if there are none.
  std::string init;
  /// Standard deviations of all edges of a graph, in place of their information; empty: none.
  std::vector<double> deviations;
};

/// Loads a problem. `source` is a file that `slom graph` or `slom bundle` reads, or a generator with the number of
/// poses or observations: `grid2d:SIZE`, `sheet:SIZE`, `grid3d:SIZE` (generate_graph.hpp), `scene:SIZE`
/// (generate_scene.hpp). Throws BadInput and the errors of slom::io and slom::initialize.
Problem loadProblem(const std::string& source, const ProblemOptions& options);

}  // namespace slom::bench
