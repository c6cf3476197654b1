/// What is fitted: a pose graph or a scene, from a file or generated.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "bundle/scene.hpp"
#include "graph/pose_graph.hpp"

namespace slom::bench {

using AnyProblem = std::variant<app::graph::PoseGraph<app::graph::Pose2>,
                                app::graph::PoseGraph<app::graph::Pose3>, app::bundle::Scene>;

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
      init;  ///< as `slom graph --init`; empty: the file's vertices, or a spanning tree where there are none
  std::vector<double> deviations;  ///< of all edges of a graph, instead of their information; empty: none
};

/// `source`: a file that `slom graph` or `slom bundle` reads; or a generated problem of about that many poses or
/// observations: `grid2d:SIZE`, `sheet:SIZE`, `grid3d:SIZE` (generate_graph.hpp), `scene:SIZE` (generate_scene.hpp). Throws
/// app::UserError.
Problem loadProblem(const std::string& source, const ProblemOptions& options);

}  // namespace slom::bench
