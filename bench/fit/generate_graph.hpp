/// Pose graphs of any size, identical on every machine.
#pragma once

#include <slom/io/pose_graph.hpp>

namespace slom::bench {

/// Generates about `size` poses on the points of a square (dimensions 2) or cubic (3) lattice with a spacing of 1 m.
/// Poses are rotated at random. Any two neighbours are connected by an edge.
///   noise of the edges   0.05 m, 0.02 rad
///   start                the truth with errors of 0.2 m and 0.05 rad; the first pose is fixed at its true value
/// A square lattice of poses in the plane is a city seen from above. A square lattice of poses in space is a surface,
/// as in sphere2500 and torus3D. In a cubic lattice the factor grows fastest.
template <class Pose>
io::PoseGraph<Pose> generateLattice(int size, int dimensions);

}  // namespace slom::bench
