// Corners so far from where the other corners of their image put them that they might mislead a fit.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Finds corners by a homography that most corners of the view agree with (least median of squares). A corner is far
/// off if its distance is 30 times the median distance and more than 20 px. Lens distortion, which the homography
/// ignores, stays far below. Skips views of fewer than 12 corners, and views that would lose more than a tenth of
/// their corners: then the view itself is wrong.
///   source   Rousseeuw, "Least median of squares regression", Journal of the American Statistical Association 79, 1984
std::vector<GrossCorner> farOffCorners(const Dataset& data);

}  // namespace slom::calibration
