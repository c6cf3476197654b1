// A chessboard whose size was given wrongly: what size it has.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"

namespace slom::app::calib {

/// For photographs in which the board was not found: what to do, with the right size where one near it is
/// found.
std::string adviceOnSize(const Board& board, const std::vector<std::string>& photos);

/// For photographs in which the board was found: UserError when it is a part of a larger one, of which the
/// detector may take another part in each photograph.
void requireWholeBoard(const Board& board, const std::vector<std::string>& photos);

}  // namespace slom::app::calib
