// Start values for fisheye lenses, whose straight lines are bent too much for homographies.
#pragma once

#include <vector>

#include "calibration/initialization/intrinsics.hpp"

namespace slom::calibration {

/// The views as a pinhole with the same numbers would have seen them, from pixels of an equidistant lens,
/// whose distance from the centre is f times the angle to the optical axis. Corners more than 80 degrees off
/// the axis are left out; a view that keeps fewer than 4 has an undefined homography (NaN).
std::vector<PlaneView> flattened(const std::vector<PlaneView>& views, const Pinhole& equidistant);

/// Focal length by trying many, centre amid the corners: whichever puts the corners nearest to their pixels.
IntrinsicsStart startFisheye(const std::vector<PlaneView>& views);

}  // namespace slom::calibration
