// Corners that lie so far from where the others of their image put them that a fit with them might not find its way.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// By a homography that most corners of the view agree with (least median of squares): what lies 30 times as far off as their median, and more than 20
/// px. A lens's distortion, which the homography does not know, stays far below. Views of fewer than 12 corners are not asked, and of one that would lose more
/// than a tenth nothing is said: then it is the view that is wrong.
///   source   Rousseeuw, "Least median of squares regression", Journal of the American Statistical Association 79, 1984
std::vector<GrossCorner> farOffCorners(const Dataset& data);

}  // namespace slom::calibration
