// Information matrices that are not positive definite.
#pragma once

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Value of eigenvalues raised by --repair-information, relative to the largest magnitude of an eigenvalue of the
/// matrix.
inline constexpr double repaired_eigenvalue = 1e-12;

/// Finds the edges and sightings whose information is not positive definite. Throws UserError with their number and
/// first lines. With `repair`, replaces each such matrix by the nearest one (in the Frobenius norm) whose eigenvalues
/// are not below repaired_eigenvalue, and returns their number.
template <class Pose>
int checkInformation(PoseGraph<Pose>& graph, bool repair);

}  // namespace slom::app::graph
