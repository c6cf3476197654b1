/// Geometry of flat boards, for code that finds or draws boards.
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// Coordinates in the plane of a board: origin at the centre of the corners, z along the normal.
struct BoardPlane {
  SE3 plane2world;
  double size = 0;       ///< root mean square distance of the corners from their centre [m]
  double thickness = 0;  ///< root mean square distance of the corners from the plane [m]

  /// Returns the coordinates of a point of the world, projected along the normal into the plane [m].
  vec2 coordinates(const vec3& world) const { return (plane2world.inverse() * world).head<2>(); }
};

/// Returns the least-squares plane of at least three corners.
BoardPlane fitPlane(const std::vector<Corner>& corners);

/// Returns whether all points, or all but one, lie on a line; they then do not determine a homography. `tolerance`:
/// root mean square width of the line, relative to its length.
bool onLineButOne(const std::vector<vec2>& points, double tolerance);

/// The smallest rectangle around all corners of the board.
struct BoardOutline {
  SE3 board2world;               ///< origin at the centre, x along the longer side, z along the normal
  double width = 0, height = 0;  ///< [m]
};
/// Returns the outline of the corners in a view.
BoardOutline outlineOf(const View& view);

/// Returns the view with the most corners, which shows most of the board.
const View& fullestView(const Dataset& data);

/// Returns H with pixel ~ H (x, y, 1) for board coordinates (x, y), by the normalised direct linear transform. Needs at
/// least four pairs, not all (or all but one) on a line. |H| = 1, and points of the board have positive depth. Source:
/// Hartley, Zisserman, Multiple View Geometry, algorithm 4.2.
Eigen::Matrix3d findHomography(const std::vector<vec2>& board, const std::vector<vec2>& pixels);

}  // namespace slom::calibration
