// Finds a board in a photograph.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photograph.hpp"

namespace slom::app::calib {

struct FoundCorner {
  int index = 0;  ///< on the board, as Board::corner counts
  vec2 pixel;     ///< the centre of the first pixel is (0, 0)
};

/// The corners by rising index; none where there is no board. A chessboard is found as a whole; of other
/// boards all visible corners are found, if they suffice for a pose. Corners of a chessboard begin at the end that
/// its colours say; where these leave that open (Board::symmetry) at the end that lies nearest to the upper
/// left of the photograph.
std::vector<FoundCorner> findBoard(const Board& board, const Photograph& photo);

/// Whether a chessboard of this size is seen at once; findBoard looks harder, and takes ten times as long
/// where there is none.
bool showsChessboard(const Board& board, const Photograph& photo);

/// The numbers of inner corners along the sides of the largest chessboard that is seen at once, the longer side first; 0, 0: there is none.
struct ChessboardSize {
  int longer = 0, shorter = 0;
  bool operator==(const ChessboardSize&) const = default;
};
ChessboardSize largestChessboard(const Photograph& photo);

/// A marker of a ChArUco board.
struct SeenMarker {
  int id = 0;
  vec2 centre;
};
/// All markers of a dictionary in a photograph.
std::vector<SeenMarker> seenMarkers(const std::string& dictionary, const Photograph& photo);

/// Whether findBoard can find such boards at all; UserError, which says what to install, where it cannot.
void requireDetector(const Board& board);

}  // namespace slom::app::calib
