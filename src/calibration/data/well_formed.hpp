// Data that cannot even be looked at: without names, without corners, with numbers that are not finite.
#pragma once

#include <string>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// Throws DataError with the first thing that is wrong: names of cameras, image sizes, images and readings that are there twice,
/// views and an IMU without content, coordinates and readings that are not finite or too large. Whatever takes a Dataset asks this first;
/// in data that pass, every loop over corners or readings has something to do, and no number becomes infinite by being squared.
void requireWellFormed(const Dataset& data);

/// `corner 7 of image 3 of camera left`; `corners[2] of image 3 of camera left` where the view has several corners of that number.
std::string nameOf(const CameraData& camera, const View& view, const Corner& corner);

}  // namespace slom::calibration
