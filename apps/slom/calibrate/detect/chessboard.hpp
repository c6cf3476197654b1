// The order of a chessboard's corners.
#pragma once

#include <vector>

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photograph.hpp"

namespace slom::app::calib {

/// Sorts the corners of a chessboard into the order that detector.hpp promises. The detector lists them row by row
/// from any end.
std::vector<vec2> inBoardOrder(const Board& board, std::vector<vec2> corners, const Photograph& photo);

}  // namespace slom::app::calib
