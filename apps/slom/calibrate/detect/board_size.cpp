#include "calibrate/detect/board_size.hpp"

#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "calibrate/detect/detector.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

constexpr std::size_t photos_to_try = 3;

bool shows(const Board& board, const std::string& file) {
  std::string reason;
  const auto photo = readPhotograph(file, reason);
  try {
    return photo && showsChessboard(board, *photo);
  } catch (const UserError&) {
    throw;
  } catch (const std::exception&) {  // thrown by OpenCV: an image that it cannot search shows no board
    return false;
  }
}

Board resized(Board board, int more_columns, int more_rows) {
  board.columns += more_columns;
  board.rows += more_rows;
  return board;
}

/// The chessboard of a size near `board` that a photograph shows.
std::optional<Board> shownInstead(const Board& board, const std::string& photo) {
  constexpr std::pair<int, int> neighbours[] = {{1, 1}, {1, 0}, {0, 1}, {0, -1}, {-1, 0}, {-1, -1}};
  for (const auto& [columns, rows] :
       neighbours) {  // larger ones first: a detector may find a part of a board
    const Board other = resized(board, columns, rows);
    if (other.columns >= 3 && other.rows >= 3 && shows(other, photo)) return other;
  }
  return {};
}

}  // namespace

void requireSizeLikely(const Board& board, const std::vector<std::string>& photos) {
  if (board.kind != BoardKind::chessboard || photos.empty()) return;
  std::string seen;
  for (std::size_t i = 0; i < std::min(photos_to_try, photos.size()); ++i) {
    if (shows(board, photos[i])) return;
    const auto other = shownInstead(board, photos[i]);
    if (!other || (i > 0 && toString(*other) != seen)) return;
    seen = toString(*other);
  }
  throw UserError(fmt::format(
      "{}: it shows a chessboard of {} inner corners, not {}; count them where four squares meet, and give "
      "--board {}",
      photos.front(), seen, toString(board), seen));
}

std::string adviceOnSize(const Board& board) {
  if (board.kind != BoardKind::chessboard) return "check its size, and that it is that kind of board";
  return "count its inner corners, where four squares meet, and see whether all of them are in the "
         "photographs";
}

void requireWholeBoard(const Board& board, const std::vector<std::string>& photos) {
  if (board.kind != BoardKind::chessboard) return;
  const std::size_t tried = std::min(photos_to_try, photos.size());
  for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(1, 0), std::pair(0, 1)}) {
    const Board larger = resized(board, columns, rows);
    for (std::size_t i = 0; i < tried && shows(larger, photos[i]); ++i) {
      if (i + 1 < tried) continue;
      throw UserError(
          fmt::format("{}: its board has {} inner corners, more than {}, so that it is open which of them "
                      "are meant; give "
                      "--board {}",
                      photos.front(), toString(larger), toString(board), toString(larger)));
    }
  }
}

}  // namespace slom::app::calib
