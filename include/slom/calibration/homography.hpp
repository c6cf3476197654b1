// The homography between a board and its image.
#pragma once

#include <vector>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// H with pixel ~ H (x, y, 1) for board coordinates (x, y), by the normalised direct linear transform. At
/// least four pairs, not all (or all but one) on a line. |H| = 1, and points of the board have positive
/// depth. Source: Hartley, Zisserman, Multiple View Geometry, algorithm 4.2.
Eigen::Matrix3d findHomography(const std::vector<vec2>& board, const std::vector<vec2>& pixels);

}  // namespace slom::calibration
