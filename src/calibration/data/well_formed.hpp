// Checks for data that no function can work with: without names, without corners, with numbers that are not finite.
#pragma once

#include <string>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// Throws DataError with the first fault: names of cameras, image sizes, images and readings that are there twice,
/// views and an IMU without content, coordinates and readings that are not finite or too large. Each function that
/// takes a Dataset calls this first. Then every loop over corners or readings has at least one element, and no square
/// of a number is infinite.
void requireWellFormed(const Dataset& data);

/// Returns `corner 7 of image 3 of camera left`, or `corners[2] of image 3 of camera left` if the view has several
/// corners with that number.
std::string nameOf(const CameraData& camera, const View& view, const Corner& corner);

}  // namespace slom::calibration
