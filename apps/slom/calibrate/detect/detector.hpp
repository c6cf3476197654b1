// The search for a board in a photograph.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photograph.hpp"

namespace slom::app::calib {

struct FoundCorner {
  int index = 0;  ///< on the board, counted as in Board::corner
  vec2 pixel;     ///< the centre of the first pixel is (0, 0)
};

/// Returns the corners by ascending index; none if there is no board. A chessboard is found as a whole. Of other
/// boards, all visible corners are found if they suffice for a pose. Corners of a chessboard begin at the end that
/// its colours determine. If the colours leave it open (Board::symmetry), they begin at the end nearest to the upper
/// left of the photograph.
std::vector<FoundCorner> findBoard(const Board& board, const Photograph& photo);

/// Returns whether a quick search sees a chessboard of this size. findBoard searches more thoroughly, and takes ten
/// times as long if there is none.
bool showsChessboard(const Board& board, const Photograph& photo);

/// Numbers of inner corners along the sides of the largest chessboard that a quick search sees, the longer side
/// first; 0, 0: none.
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
/// Returns all markers of a dictionary in a photograph.
std::vector<SeenMarker> seenMarkers(const std::string& dictionary, const Photograph& photo);

/// Throws UserError, which says what to install, if findBoard cannot find such boards at all.
void requireDetector(const Board& board);

}  // namespace slom::app::calib
