// What is known of the views of a camera beside their corners.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// How the corners of a view move from one image number to the next.
struct ViewMotion {
  std::vector<Eigen::Vector2d> of_corners;  ///< as in the view [px]; NaN: unknown
  double speed = 0;                         ///< median of their lengths [px]; NaN: unknown
};

/// Of all views, from those before and after, where these are not much farther away than usual. The views are sorted by image number.
std::vector<ViewMotion> motionsOf(const CameraData& camera);

/// How the camera sees the corners of a view.
struct ViewGeometry {
  double slant = 0;     ///< angle between the line of sight to their centre and the normal of the board [rad]
  double distance = 0;  ///< of their centre [m]
};
/// `normal`: of the board, in the world.
ViewGeometry geometryOf(const View& view, const SE3& world2camera, const Eigen::Vector3d& normal);

}  // namespace slom::calibration
