// Facts about the views of a camera, besides their corners.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// The motion of the corners of a view from one image number to the next.
struct ViewMotion {
  std::vector<Eigen::Vector2d> of_corners;  ///< in the order of the view [px]; NaN: unknown
  double speed = 0;                         ///< median of their lengths [px]; NaN: unknown
};

/// Returns the motion of all views from the views before and after, if their image numbers are not much farther away
/// than usual. The views must be sorted by image number.
std::vector<ViewMotion> motionsOf(const CameraData& camera);

/// The position of the corners of a view relative to the camera.
struct ViewGeometry {
  double slant = 0;     ///< angle between the line of sight to their centre and the normal of the board [rad]
  double distance = 0;  ///< distance of their centre [m]
};
/// Returns the geometry of a view. `normal` is the normal of the board in the world.
ViewGeometry geometryOf(const View& view, const SE3& world2camera, const Eigen::Vector3d& normal);

}  // namespace slom::calibration
