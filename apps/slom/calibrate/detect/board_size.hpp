// A chessboard whose size was given wrongly: what size it has.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"

namespace slom::app::calib {

/// Eight photographs at most, evenly over all of them, for a quick look.
std::vector<std::string> someOf(const std::vector<std::string>& photos);

/// A quick look before the search in all photographs, which takes long where there is nothing: UserError when
/// the first ones show no chessboard of this size, but all of them one of another size.
void requireSizeLikely(const Board& board, const std::vector<std::string>& photos);

/// What to do where the board was found in no photograph.
std::string adviceOnSize(const Board& board);

/// For photographs in which the board was found: UserError when it is a part of a larger one, of which the
/// detector may take another part in each photograph.
void requireWholeBoard(const Board& board, const std::vector<std::string>& photos);

}  // namespace slom::app::calib
