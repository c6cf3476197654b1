/// Bundle adjustment of any size, identical on every machine.
#pragma once

#include <slom/io/scene.hpp>

namespace slom::bench {

/// Generates aerial photographs of hilly ground, with about `size` observations. Cameras on a square lattice look down
/// from a height of 3 (in spacings of the lattice) with tilts of 0.1 rad. Points of the ground are between -0.5 and
/// 0.5. The 5 nearest cameras see each point; each camera sees about 1000 points.
///   noise   0.5 px, focal length 1000 px
///   start   the truth with errors of 0.01 rad, 0.02, 1 % of the focal length, 0.01 in k1; 0.05 for points
io::Scene generateScene(int size);

}  // namespace slom::bench
