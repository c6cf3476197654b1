/// Bundle adjustment of any size, the same on every machine.
#pragma once

#include <slom/io/scene.hpp>

namespace slom::bench {

/// Aerial photographs of hilly ground, about `size` observations: cameras on a square lattice look down from a height of 3
/// (in spacings of the lattice) with tilts of 0.1 rad; each point of the ground, between -0.5 and 0.5, is seen by the 5
/// cameras nearest to it, and each camera sees about 1000 points.
///   noise   0.5 px, focal length 1000 px
///   start   the truth with errors of 0.01 rad, 0.02, 1 % of the focal length, 0.01 in k1; 0.05 for points
io::Scene generateScene(int size);

}  // namespace slom::bench
