#include "calibrate/detect/board.hpp"

#include <cmath>

#include <fmt/format.h>

#include "error.hpp"
#include "plausible.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

constexpr const char* board_syntax =
    "write 9x6 (inner corners of a chessboard), charuco:8x5:4x4_50 (squares, dictionary) or aprilgrid:6x6 "
    "(tags)";

/// `9x6`
bool parseSize(std::string_view text, int& columns, int& rows) {
  const auto x = text.find('x');
  return x != std::string_view::npos && parseNumber(text.substr(0, x), columns) &&
         parseNumber(text.substr(x + 1), rows);
}

/// Kind, size and dictionary; no lengths yet.
Board parseName(const std::string& text) {
  Board board;
  std::string rest = text;
  if (rest.starts_with("charuco:")) {
    board.kind = BoardKind::charuco;
    rest.erase(0, 8);
    const auto colon = rest.find(':');
    if (colon == std::string::npos) {
      throw UserError(fmt::format(
          "--board {0}: say which dictionary its markers are from, as in --board {0}:4x4_50", text));
    }
    board.dictionary = rest.substr(colon + 1);
    rest.erase(colon);
  } else if (rest.starts_with("aprilgrid:")) {
    board.kind = BoardKind::aprilgrid;
    rest.erase(0, 10);
  }
  if (!parseSize(rest, board.columns, board.rows))
    throw UserError(fmt::format("--board {}: {}", text, board_syntax));
  return board;
}

void requireSize(const Board& board, const std::string& text) {
  const bool is_chessboard = board.kind == BoardKind::chessboard;
  const int least = is_chessboard || board.kind == BoardKind::charuco ? 3 : 1;
  if (board.columns >= least && board.rows >= least && board.columns <= 100 && board.rows <= 100) return;
  throw UserError(fmt::format("--board {}: {} x {} {}; give {} to 100 in each direction", text, board.columns,
                              board.rows,
                              is_chessboard                      ? "inner corners cannot be detected"
                              : board.kind == BoardKind::charuco ? "squares cannot be detected"
                                                                 : "tags do not form a grid",
                              least));
}

/// What an option must lie between.
struct Range {
  double least, most;
  const char* unit;
};
constexpr Range lengths{least_square_m, most_square_m, " m"}, spacings{least_spacing, most_spacing, ""};

/// A length or ratio that the board has or has not.
void requireLength(const char* option, double value, const Range& range, bool is_wanted,
                   const std::string& board, const char* example) {
  if (value != 0 && !(value > 0 && std::isfinite(value))) {
    throw UserError(fmt::format("{} {}: give a positive number", option, value));
  }
  if (is_wanted && value == 0)
    throw UserError(fmt::format("--board {} needs {}, as in {} {}", board, option, option, example));
  if (!is_wanted && value != 0)
    throw UserError(fmt::format("{} {}: --board {} has no such length; leave it out", option, value, board));
  if (value != 0 && (value < range.least || value > range.most)) {
    throw UserError(fmt::format("{} {}: boards that can be printed have {:g} to {:g}{}; give such a value",
                                option, value, range.least, range.most, range.unit));
  }
}

}  // namespace

int Board::cornerColumns() const {
  return kind == BoardKind::chessboard ? columns : kind == BoardKind::charuco ? columns - 1 : 2 * columns;
}

int Board::cornerRows() const {
  return kind == BoardKind::chessboard ? rows : kind == BoardKind::charuco ? rows - 1 : 2 * rows;
}

vec3 Board::corner(int index) const {
  const int column = index % cornerColumns(), row = index / cornerColumns();
  const auto along = [&](int i) {
    if (kind != BoardKind::aprilgrid) return i * square_m;
    return (i / 2) * (1 + spacing) * square_m + (i % 2) * square_m;
  };
  return vec3(along(column), along(row), 0.);
}

int Board::symmetry() const {
  if (kind != BoardKind::chessboard || (columns + rows) % 2 == 1) return 1;
  return columns == rows && columns % 2 == 0 ? 4 : 2;
}

std::string toString(const Board& board) {
  const std::string size = fmt::format("{}x{}", board.columns, board.rows);
  switch (board.kind) {
    case BoardKind::charuco:
      return "charuco:" + size + ":" + board.dictionary;
    case BoardKind::aprilgrid:
      return "aprilgrid:" + size;
    case BoardKind::chessboard:
      break;
  }
  return size;
}

Board parseBoard(const BoardOptions& options) {
  if (options.board.empty())
    throw UserError("--images needs --board, as in --board 9x6 for 9 x 6 inner corners of a chessboard");
  Board board = parseName(options.board);
  requireSize(board, options.board);
  requireLength("--square", options.square_m, lengths, true, options.board, "0.025 [m]");
  requireLength("--marker", options.marker_m, lengths, board.kind == BoardKind::charuco, options.board,
                "0.018 [m]");
  requireLength("--spacing", options.spacing, spacings, board.kind == BoardKind::aprilgrid, options.board,
                "0.3 (of a tag's side)");
  if (board.kind == BoardKind::charuco && options.marker_m >= options.square_m) {
    throw UserError(fmt::format("--marker {}: a marker lies within a square of {} m; give a smaller one",
                                options.marker_m, options.square_m));
  }
  board.square_m = options.square_m;
  board.marker_m = options.marker_m;
  board.spacing = options.spacing;
  return board;
}

}  // namespace slom::app::calib
