// Pose graphs in the library's types, with nodes and edges.
#pragma once

#include <slom/io/pose_graph.hpp>

namespace slom::app::graph {

using io::dim;
using io::dof;
using io::Edge;
using io::Node;
using io::Point;
using io::Pose2;
using io::Pose3;
using io::PoseGraph;
using io::Symmetric;

}  // namespace slom::app::graph
