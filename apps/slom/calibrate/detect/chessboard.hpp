// The order of a chessboard's corners.
#pragma once

#include <vector>

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photograph.hpp"

namespace slom::app::calib {

/// Corners of a chessboard as a detector lists them, row by row from any end: the same in the order that
/// detector.hpp promises.
std::vector<vec2> inBoardOrder(const Board& board, std::vector<vec2> corners, const Photograph& photo);

}  // namespace slom::app::calib
