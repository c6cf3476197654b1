// The plane that the corners of a view lie in, and whether they pin down a homography.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// Coordinates in the plane of a board: origin at the centre of the corners, z along the normal.
struct BoardPlane {
  SE3 plane2world;
  double size = 0;       ///< root mean square distance of the corners from their centre [m]
  double thickness = 0;  ///< root mean square distance of the corners from the plane [m]

  vec2 coordinates(const vec3& world) const { return (plane2world.inverse() * world).head<2>(); }
};

/// Least squares plane of at least three corners.
BoardPlane fitPlane(const std::vector<Corner>& corners);

/// Whether all points, or all but one, lie on a line: then they do not determine a homography.
/// `tolerance`: root mean square width of the line, as a part of its length.
bool onLineButOne(const std::vector<vec2>& points, double tolerance);

}  // namespace slom::calibration
