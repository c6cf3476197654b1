/// Geometry of flat boards, for those who find them in images or draw them.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// Coordinates in the plane of a board: origin at the centre of the corners, z along the normal.
struct BoardPlane {
  SE3 plane2world;
  double size = 0;       ///< root mean square distance of the corners from their centre [m]
  double thickness = 0;  ///< root mean square distance of the corners from the plane [m]

  /// A point of the world, projected along the normal into the plane [m].
  vec2 coordinates(const vec3& world) const { return (plane2world.inverse() * world).head<2>(); }
};

/// Least squares plane of at least three corners.
BoardPlane fitPlane(const std::vector<Corner>& corners);

/// Whether all points, or all but one, lie on a line: then they do not determine a homography.
/// `tolerance`: root mean square width of the line, as a part of its length.
bool onLineButOne(const std::vector<vec2>& points, double tolerance);

/// The smallest rectangle about all corners of the board.
struct BoardOutline {
  SE3 board2world;               ///< origin at the centre, x along the longer side, z along the normal
  double width = 0, height = 0;  ///< [m]
};
/// The outline of the corners that a view has.
BoardOutline outlineOf(const View& view);

/// The view with the most corners: what is known of the board.
const View& fullestView(const Dataset& data);

/// H with pixel ~ H (x, y, 1) for board coordinates (x, y), by the normalised direct linear transform. At
/// least four pairs, not all (or all but one) on a line. |H| = 1, and points of the board have positive
/// depth. Source: Hartley, Zisserman, Multiple View Geometry, algorithm 4.2.
Eigen::Matrix3d findHomography(const std::vector<vec2>& board, const std::vector<vec2>& pixels);

}  // namespace slom::calibration
