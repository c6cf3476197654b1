// Boards that are all parallel to each other leave the focal length open, however many there are.
#pragma once

#include <string>
#include <vector>

#include "calibration/initialization/plane_view.hpp"

namespace slom::calibration {

/// The largest angle between the normal of a board and their mean [rad], as a camera sees them whose focal length is the
/// extent of its corners in the images. Parallel boards have the same vanishing line, for whatever focal length, so the
/// angle is 0 for them but for noise.
///   source   Zhang, "A flexible new technique for camera calibration", 2000, section 4 (degenerate configurations)
double normalSpread(const std::vector<PlaneView>& views);

/// A sentence when the boards that each of the cameras sees are parallel, within 2 degrees; empty otherwise. `views`: by camera;
/// `images`: the number of images.
std::string parallelViews(const std::vector<std::vector<PlaneView>>& views, std::size_t images);

}  // namespace slom::calibration
