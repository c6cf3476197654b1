// Where the board stands before the camera, from one view and known intrinsics without distortion.
#pragma once

#include "calibration/initialization/plane_view.hpp"
#include "calibration/models/camera.hpp"

namespace slom::calibration {

/// World to camera, from the homography: rotation by the nearest orthonormal matrix, board before the camera.
SE3 poseFromHomography(const PlaneView& view, const Pinhole& camera);

/// The pose that looks nearly the same when the board is small or far: tilted the other way, about the line
/// of observation to its centre.
SE3 tiltedOtherWay(const PlaneView& view, const SE3& world2camera);

/// Sum of squared distances between the corners and their pixels [px^2]; infinite if a corner lies behind the
/// camera.
double squaredPixelError(const PlaneView& view, const Pinhole& camera, const SE3& world2camera);

}  // namespace slom::calibration
