/// Pose graphs of any size, the same on every machine.
#pragma once

#include <slom/io/pose_graph.hpp>

namespace slom::bench {

/// About `size` poses on the points of a square (dimensions 2) or cubic (3) lattice with a spacing of 1 m, turned at
/// random, and an edge between any two neighbours.
///   noise of the edges   0.05 m, 0.02 rad
///   start                the truth with errors of 0.2 m and 0.05 rad; the first pose is fixed at its true value
/// A square lattice of poses in the plane is a city seen from above; of poses in space it is a surface, as in sphere2500 and
/// torus3D. In a cubic lattice the factor grows fastest.
template <class Pose>
io::PoseGraph<Pose> generateLattice(int size, int dimensions);

}  // namespace slom::bench
