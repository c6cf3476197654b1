// Boards with identified corners: ChArUco and AprilGrid.
#pragma once

#include "calibrate/detect/detector.hpp"

namespace slom::app::calib {

/// Does the work of findBoard for boards that are not chessboards.
std::vector<FoundCorner> findMarkers(const Board& board, const Photograph& photo);

/// Throws UserError if there is no such dictionary, or if it has fewer markers than the board.
void requireDictionary(const Board& board);

}  // namespace slom::app::calib
