// Poses from all edges at once, by two linear least-squares problems.
#pragma once

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// First the rotations: min sum w |R_j - R_i Z_ij|_F^2 over matrices R_i that need not be rotations, which is
/// linear, then each matrix by the rotation nearest to it. Then the positions: min sum w |t_j - t_i - R_i
/// t_ij|^2. w is the mean of the information's diagonal. Held poses keep their values; each other must be
/// connected with one.
///   source   Carlone, Tron, Daniilidis and Dellaert, "Initialization techniques for 3D SLAM: a survey on
///   rotation
///            estimation and its use in pose graph optimization", ICRA 2015, section III.B
template <class Pose>
void relaxChordally(PoseGraph<Pose>& graph);

}  // namespace slom::app::graph
