// Reasons against trusting a calibration, from its assessment.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Largest projection uncertainty in the image of a trustworthy calibration, at the distance of the boards and at
/// infinity.
inline constexpr double worst_bearable_px = 3;
/// Largest standard deviations of a trustworthy calibration: of the focal length, relative, and of the centre,
/// relative to the longer side of the image.
inline constexpr double most_focal_std = 0.01, most_centre_std = 0.02;
/// Boards are nearly parallel if their normals differ by less than this from their mean [rad].
inline constexpr double nearly_parallel = 0.26;  // 15 degrees

/// Returns the doubts about a result with an assessment, one clause each, the gravest first.
std::vector<std::string> doubtsOf(const Result& result);

/// Adds what the boards leave undetermined: projection at the distance of the boards and far away, focal length and
/// centre. Names the cause and a remedy.
void doubtProjection(const Result& result, std::vector<std::string>& doubts);

/// Adds wrong times of images and rows, by their residuals.
void doubtTimes(const Result& result, std::vector<std::string>& doubts);

/// Adds disagreements between halves of the images, or that they cannot be compared.
void doubtHalves(const Result& result, std::vector<std::string>& doubts);

/// Returns `a board tilted by 40 degrees, its left edge farther away, in the upper left of the image of left, at 0.60
/// m`.
std::string placeOf(const FurtherView& view, const Result& result);

}  // namespace slom::calibration
