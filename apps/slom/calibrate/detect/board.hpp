// The calibration boards: the positions of their corners, and the number of ways in which a board looks the same.
//   chessboard  columns x rows inner corners, x along the rows, y down; the first inner square is dark if the
//               colours distinguish the ends
//   charuco     columns x rows squares, black ones and white ones with ArUco markers in them; corners are
//               the inner ones
//   aprilgrid   columns x rows tags of the family 36h11, small squares between them; x right, y up, four
//               corners for each tag. As Kalibr prints it; tag 0 is at the lower left
//   circles     columns x rows circles in a grid, or odd rows shifted by half a spacing; only in corner files
#pragma once

#include <optional>
#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

enum class BoardKind { chessboard, charuco, aprilgrid, circles };

struct Board {
  BoardKind kind = BoardKind::chessboard;
  int columns = 0, rows = 0;   ///< inner corners, squares or tags
  double square_m = 0;         ///< side of a square; aprilgrid: of a tag; circles: distance between circles
  double row_m = 0;            ///< chessboard: distance of rows if it is different; 0: it is the same
  double marker_m = 0;         ///< charuco: side of a marker
  double spacing = 0;          ///< aprilgrid: gap between tags, as a fraction of their side
  std::string dictionary;      ///< charuco: dictionary of the markers, as "5x5_100"
  bool is_asymmetric = false;  ///< circles: odd rows are shifted

  /// Returns the size of the grid of corners.
  int cornerColumns() const;
  int cornerRows() const;
  int cornerCount() const { return cornerColumns() * cornerRows(); }
  /// Returns the position of the corner with this index, counted row by row [m].
  vec3 corner(int index) const;
  /// Returns in how many ways the board can be turned and still look the same: 1, 2 or 4.
  int symmetry() const;
};

/// Returns `9x6`, `charuco:8x5:4x4_50`, `aprilgrid:6x6`, `circles:7x5`.
std::string toString(const Board& board);

/// The options as the user wrote them; 0 for those left out.
struct BoardOptions {
  std::string board;
  double square_m = 0, marker_m = 0, spacing = 0;
};

/// Returns the board of photographs. `options.board` may be the file of a Kalibr target. Throws UserError that names
/// the option that is wrong, missing, or belongs to another board.
Board parseBoard(const BoardOptions& options);

/// Throws UserError if corners of a board are so far apart that the length is unlikely in metres. `across_m`: their
/// distance [m]. `option` gives the length `value`.
void requireMetres(const std::string& option, double value, double across_m);

/// Returns the board of corner files that do not say where their corners lie; missing parts may be in the files.
/// Returns nothing if no option is given.
std::optional<BoardOfFiles> parseBoardOfFiles(const BoardOptions& options);

}  // namespace slom::app::calib
