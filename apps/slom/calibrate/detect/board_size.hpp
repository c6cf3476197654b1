// The true size of a chessboard whose stated size is wrong.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"

namespace slom::app::calib {

/// Returns at most eight photographs, evenly from all of them, for a quick look.
std::vector<std::string> someOf(const std::vector<std::string>& photos);

/// Takes a quick look before the search in all photographs, which takes long if there is nothing to find. Throws
/// UserError if the first photographs show no chessboard of this size, but all show one of another size.
void requireSizeLikely(const Board& board, const std::vector<std::string>& photos);

/// Returns what to do if no photograph shows the board.
std::string adviceOnSize(const Board& board);

/// Checks photographs in which the board was found. Throws UserError if the board is a part of a larger one, of which
/// the detector may find a different part in each photograph.
void requireWholeBoard(const Board& board, const std::vector<std::string>& photos);

}  // namespace slom::app::calib
