/// What is fitted: a pose graph or a scene, from a file or generated.
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
  std::string start;  ///< where the fit starts, in a few words
  AnyProblem data;

  bool isGraph() const { return data.index() < 2; }
  std::size_t variables() const;
  std::size_t measurements() const;
};

struct ProblemOptions {
  std::string
      init;  ///< as `slom graph --init`, where odometry follows the order of the file; empty: the file's vertices, or a spanning tree where there are none
  std::vector<double>
      deviations;  ///< standard deviations of all edges of a graph, instead of their information; empty: none
};

/// `source`: a file that `slom graph` or `slom bundle` reads; or a generated problem of about that many poses or
/// observations: `grid2d:SIZE`, `sheet:SIZE`, `grid3d:SIZE` (generate_graph.hpp), `scene:SIZE` (generate_scene.hpp). Throws
/// BadInput and the errors of slom::io and slom::initialize.
Problem loadProblem(const std::string& source, const ProblemOptions& options);

}  // namespace slom::bench
