// The board as a rectangle.
#pragma once

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// The smallest rectangle about all corners of the board.
struct BoardOutline {
  SE3 board2world;               ///< origin at the centre, x along the longer side, z along the normal
  double width = 0, height = 0;  ///< [m]
};
BoardOutline outlineOf(const View& view);

/// The view with the most corners: what is known of the board.
const View& fullestView(const Dataset& data);

}  // namespace slom::calibration
