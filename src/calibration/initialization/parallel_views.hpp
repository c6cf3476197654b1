// Boards parallel to each other: they leave the focal length open, in any number.
#pragma once

#include <string>
#include <vector>

#include "calibration/initialization/plane_view.hpp"

namespace slom::calibration {

/// Returns the largest angle between the normal of a board and their mean [rad]. Assumes a camera whose focal length
/// is the extent of its corners in the images. For any focal length, parallel boards have the same vanishing line, so
/// their angle is 0 up to noise.
///   source   Zhang, "A flexible new technique for camera calibration", 2000, section 4 (degenerate configurations)
double normalSpread(const std::vector<PlaneView>& views);

/// Returns a sentence if, for each camera, the boards it sees are parallel within 2 degrees; empty otherwise.
/// `views`: by camera; `images`: the number of images.
std::string parallelViews(const std::vector<std::vector<PlaneView>>& views, std::size_t images);

}  // namespace slom::calibration
