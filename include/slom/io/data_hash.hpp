/// Hashes of the data of a problem: the measurements and what they are of.
#pragma once

#include <cstdint>
#include <vector>

#include "slom/io/pose_graph.hpp"
#include "slom/io/scene.hpp"

namespace slom::io {

/// Returns a hash of all measured values and the ids of their vertices. Start values and information do not count. The
/// hash of a whole graph is the sum, modulo 2^64, of the hashes of parts that share no measurement.
template <class Pose>
std::uint64_t dataHash(const PoseGraph<Pose>& graph);

/// Returns the same of a scene: pixels, with the numbers of their cameras and points. `cameras` and `points`: by place in
/// the scene, the numbers in the file; empty: each place is the number.
std::uint64_t dataHash(const Scene& scene, const std::vector<int>& cameras = {},
                       const std::vector<int>& points = {});

}  // namespace slom::io
