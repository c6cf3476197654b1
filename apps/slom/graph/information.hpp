// Information matrices that are not positive definite.
#pragma once

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Eigenvalues that --repair-information raises become this share of the largest magnitude among them.
inline constexpr double repaired_eigenvalue = 1e-12;

/// Finds the edges and sightings whose information is not positive definite. Throws UserError with their
/// number and first lines; with `repair` replaces each matrix by the nearest one (in the Frobenius norm)
/// whose eigenvalues are not below repaired_eigenvalue, and returns how many there were.
template <class Pose>
int checkInformation(PoseGraph<Pose>& graph, bool repair);

}  // namespace slom::app::graph
