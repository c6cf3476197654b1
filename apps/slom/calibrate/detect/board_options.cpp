#include <cmath>

#include <fmt/format.h>

#include "calibrate/detect/board.hpp"
#include "error.hpp"
#include "plausible.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

constexpr const char* board_syntax =
    "write 9x6 (inner corners of a chessboard), charuco:8x5:4x4_50 (squares, dictionary), aprilgrid:6x6 "
    "(tags), or the YAML file of a Kalibr target";

/// Parses `9x6`.
bool parseSize(std::string_view text, int& columns, int& rows) {
  const auto x = text.find('x');
  return x != std::string_view::npos && parseNumber(text.substr(0, x), columns) &&
         parseNumber(text.substr(x + 1), rows);
}

/// Parses kind, size and dictionary. Sets no lengths.
Board parseName(const std::string& text) {
  Board board;
  std::string rest = text;
  if (rest.starts_with("charuco:")) {
    board.kind = BoardKind::charuco;
    rest.erase(0, 8);
    const auto colon = rest.find(':');
    if (colon == std::string::npos) {
      throw UserError(fmt::format(
          "--board {0}: the dictionary of the markers is missing; give it, as in --board {0}:4x4_50", text));
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
                              : board.kind == BoardKind::circles ? "circles do not form a grid"
                                                                 : "tags do not form a grid",
                              least));
}

/// Limits of an option.
struct Range {
  double least, most;
  const char* unit;
};
constexpr Range lengths{least_square_m, most_square_m, " m"}, spacings{least_spacing, most_spacing, ""};

/// Checks a length or ratio that the board needs or does not have.
void requireLength(const char* option, double value, const Range& range, bool is_wanted,
                   const std::string& board, const char* example) {
  if (value != 0 && !(value > 0 && std::isfinite(value))) {
    throw UserError(fmt::format("{} {}: give a positive number", option, value));
  }
  if (is_wanted && value == 0)
    throw UserError(fmt::format("--board {} needs {}, as in {} {}", board, option, option, example));
  if (!is_wanted && value != 0)
    throw UserError(
        fmt::format("{} {}: --board {} has no such length; drop this option", option, value, board));
  if (value != 0 && (value < range.least || value > range.most)) {
    throw UserError(fmt::format("{} {}: out of range for a printed board; give {:g} to {:g}{}", option, value,
                                range.least, range.most, range.unit));
  }
}

double acrossOf(const Board& board) {
  return (board.corner(board.cornerCount() - 1) - board.corner(0)).norm();
}

/// Checks the lengths that the options give, and sets those of the board. A chessboard's square may be left out if it
/// is not needed.
void requireLengths(Board& board, const BoardOptions& options, bool square_is_needed) {
  requireLength("--square", options.square_m, lengths, square_is_needed || options.square_m != 0,
                options.board, "0.025 [m]");
  requireLength("--marker", options.marker_m, lengths, board.kind == BoardKind::charuco, options.board,
                "0.018 [m]");
  requireLength("--spacing", options.spacing, spacings, board.kind == BoardKind::aprilgrid, options.board,
                "0.3 (of a tag's side)");
  if (options.marker_m > most_board_m) requireMetres("--marker", options.marker_m, options.marker_m);
  if (board.kind == BoardKind::charuco && options.marker_m >= options.square_m) {
    throw UserError(fmt::format("--marker {}: a marker lies within a square of {} m; give a smaller one",
                                options.marker_m, options.square_m));
  }
  board.square_m = options.square_m;
  board.marker_m = options.marker_m;
  board.spacing = options.spacing;
}

/// Returns whether the text names a file. No name of a board has a dot or a slash.
bool isTargetFile(const std::string& text) { return text.find_first_of("./") != std::string::npos; }

/// Reads a Kalibr target, which has all lengths.
Board boardOfTarget(const BoardOptions& options) {
  const KalibrTarget target = readKalibrTarget(options.board);
  for (const auto& [option, value] : {std::pair("--square", options.square_m),
                                      {"--marker", options.marker_m},
                                      {"--spacing", options.spacing}}) {
    if (value != 0)
      throw UserError(fmt::format("{} {}: {} already states the lengths of the board; drop this option",
                                  option, value, options.board));
  }
  Board board;
  board.columns = target.columns, board.rows = target.rows;
  BoardOptions lengths_of_target{.board = options.board, .square_m = target.column_spacing_m};
  if (target.kind == KalibrTarget::Kind::aprilgrid) {
    board.kind = BoardKind::aprilgrid;
    lengths_of_target.square_m = target.tag_m, lengths_of_target.spacing = target.spacing;
  } else if (target.kind == KalibrTarget::Kind::circlegrid) {
    board.kind = BoardKind::circles;
    board.is_asymmetric = target.is_asymmetric;
  }
  requireSize(board, options.board);
  requireLengths(board, lengths_of_target, true);
  if (target.row_spacing_m != target.column_spacing_m) board.row_m = target.row_spacing_m;
  if (const double across = acrossOf(board); across > most_board_m) {
    throw UserError(
        fmt::format("{}: the board would be {:.3g} m across; are its lengths in millimetres? write metres",
                    options.board, across));
  }
  return board;
}

/// Returns the corners of an AprilGrid in Kalibr's order: tag by tag, each counterclockwise from the lower left.
std::vector<vec3> cornersByTag(const Board& board) {
  std::vector<vec3> corners;
  for (int tag = 0; tag < board.columns * board.rows; ++tag) {
    for (const auto& [right, up] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
      const int column = 2 * (tag % board.columns) + right, row = 2 * (tag / board.columns) + up;
      corners.push_back(board.corner(row * board.cornerColumns() + column));
    }
  }
  return corners;
}

}  // namespace

void requireMetres(const std::string& option, double value, double across_m) {
  if (across_m <= most_board_m) return;
  throw UserError(fmt::format(
      "{0} {1}: the {2} would be {3:.3g} m across; is the number in millimetres? give metres: {0} {4:g}",
      option, value, option == "--marker" ? "marker" : "board", across_m, value / 1000));
}

Board parseBoard(const BoardOptions& options) {
  if (options.board.empty())
    throw UserError("--images needs --board, as in --board 9x6 for 9 x 6 inner corners of a chessboard");
  if (isTargetFile(options.board)) {
    const Board board = boardOfTarget(options);
    if (board.kind != BoardKind::circles) return board;
    throw UserError(
        fmt::format("--board {}: circles cannot be found in photographs; give corner files by --camera, or "
                    "photographs of a chessboard, ChArUco board or AprilGrid",
                    options.board));
  }
  Board board = parseName(options.board);
  requireSize(board, options.board);
  requireLengths(board, options, true);
  requireMetres("--square", options.square_m, acrossOf(board));
  return board;
}

std::optional<BoardOfFiles> parseBoardOfFiles(const BoardOptions& options) {
  Board board;
  if (options.board.empty()) {
    requireLength("--square", options.square_m, lengths, options.square_m != 0, "", "");
    if (options.square_m == 0) return {};
    return BoardOfFiles{.square_m = options.square_m};
  }
  if (isTargetFile(options.board)) {
    board = boardOfTarget(options);
  } else {
    board = parseName(options.board);
    requireSize(board, options.board);
    requireLengths(board, options, board.kind != BoardKind::chessboard);
    requireMetres("--square", options.square_m, acrossOf(board));
  }
  BoardOfFiles known{board.cornerColumns(), board.cornerRows(), board.square_m};
  if (board.square_m == 0) return known;
  for (int i = 0; i < board.cornerCount(); ++i) known.points.push_back(board.corner(i));
  if (board.kind == BoardKind::aprilgrid) known.numbered = cornersByTag(board);
  return known;
}

}  // namespace slom::app::calib
