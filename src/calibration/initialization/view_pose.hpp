// The pose of the board before the camera, from one view and known intrinsics without distortion.
#pragma once

#include "calibration/initialization/plane_view.hpp"
#include "calibration/models/camera.hpp"

namespace slom::calibration {

/// Returns world to camera from the homography: the nearest orthonormal matrix as rotation, the board before the
/// camera.
SE3 poseFromHomography(const PlaneView& view, const Pinhole& camera);

/// Returns the pose that looks nearly the same if the board is small or far: tilted the other way, about the line of
/// sight to its centre.
SE3 tiltedOtherWay(const PlaneView& view, const SE3& world2camera);

/// Returns the sum of squared distances between the corners and their pixels [px^2]; infinite if a corner lies behind
/// the camera.
double squaredPixelError(const PlaneView& view, const Pinhole& camera, const SE3& world2camera);

}  // namespace slom::calibration
