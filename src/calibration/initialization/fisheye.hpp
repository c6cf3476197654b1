// Start values for fisheye lenses, which bend straight lines too much for homographies.
#pragma once

#include <vector>

#include "calibration/initialization/intrinsics.hpp"

namespace slom::calibration {

/// Returns the views as a pinhole with the same numbers would have seen them. The pixels come from an equidistant
/// lens, whose distance from the centre is f times the angle to the optical axis. Leaves out corners more than 80
/// degrees off the axis. A view that keeps fewer than 4 corners has an undefined homography (NaN).
std::vector<PlaneView> flattened(const std::vector<PlaneView>& views, const Pinhole& equidistant);

/// Tries many focal lengths with the centre amid the corners, and keeps the one that puts the corners nearest to
/// their pixels.
IntrinsicsStart startFisheye(const std::vector<PlaneView>& views);

}  // namespace slom::calibration
