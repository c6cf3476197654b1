// Boards whose corners have names: ChArUco and AprilGrid.
#pragma once

#include "calibrate/detect/detector.hpp"

namespace slom::app::calib {

/// As findBoard, for boards that are not chessboards.
std::vector<FoundCorner> findMarkers(const Board& board, const Photograph& photo);

/// UserError when there is no such dictionary, or it has fewer markers than the board.
void requireDictionary(const Board& board);

}  // namespace slom::app::calib
