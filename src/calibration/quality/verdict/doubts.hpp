// What speaks against trusting a calibration, of all that its assessment shows.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The largest projection uncertainty in the image that a calibration can be trusted with, at the distance of the boards and at infinity.
inline constexpr double worst_bearable_px = 3;
/// Likewise, of the focal length as a part of it, and of the centre as a part of the longer side of the image.
inline constexpr double most_focal_std = 0.01, most_centre_std = 0.02;
/// Boards whose normals differ by less from their mean are nearly parallel [rad].
inline constexpr double nearly_parallel = 0.26;  // 15 degrees

/// A clause each, the gravest first. Of a result with an assessment.
std::vector<std::string> doubtsOf(const Result& result);

/// What the boards leave open of the cameras: projection at the distance of the boards and far away, focal length and centre, with the
/// cause and what would help.
void doubtProjection(const Result& result, std::vector<std::string>& doubts);

/// What halves of the images say, or that they cannot be compared.
void doubtHalves(const Result& result, std::vector<std::string>& doubts);

/// `a board tilted by 40 degrees, its left edge farther away, in the upper left of the image of left, at 0.60 m`
std::string placeOf(const FurtherView& view, const Result& result);

}  // namespace slom::calibration
