#include "calibrate/detect/board_size.hpp"

#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "calibrate/detect/detector.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

/// Returns the answer of `ask` for a photograph. If the photograph cannot be read or searched, returns the answer for
/// none.
template <class Answer>
Answer asked(const std::string& file, Answer (*ask)(const Board&, const Photograph&), const Board& board) {
  std::string reason;
  const auto photo = readPhotograph(file, reason);
  try {
    return photo ? ask(board, *photo) : Answer();
  } catch (const UserError&) {
    throw;
  } catch (const std::exception&) {  // thrown by OpenCV for an image that it cannot search: no board
    return {};
  }
}

bool shows(const Board& board, const std::string& file) { return asked<bool>(file, &showsChessboard, board); }

ChessboardSize largest(const std::string& file) {
  return asked<ChessboardSize>(
      file, [](const Board&, const Photograph& photo) { return largestChessboard(photo); }, {});
}

ChessboardSize sizeOf(const Board& board) {
  return {std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
}

bool isNone(const ChessboardSize& size) { return size.longer == 0; }

/// Returns whether `a` is larger along at least one side, and smaller along none.
bool isLarger(const ChessboardSize& a, const ChessboardSize& b) {
  return a.longer >= b.longer && a.shorter >= b.shorter && a != b;
}

/// Returns a chessboard of that size. Its longer side has the direction of that of `like`.
Board chessboardOf(const ChessboardSize& size, Board like) {
  const bool is_wide = like.columns >= like.rows;
  like.columns = is_wide ? size.longer : size.shorter;
  like.rows = is_wide ? size.shorter : size.longer;
  return like;
}

}  // namespace

std::vector<std::string> someOf(const std::vector<std::string>& photos) {
  constexpr std::size_t most = 8;
  std::vector<std::string> some;
  const std::size_t count = std::min(most, photos.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(photos[i * photos.size() / count]);
  return some;
}

void requireSizeLikely(const Board& board, const std::vector<std::string>& photos) {
  if (board.kind != BoardKind::chessboard) return;
  const ChessboardSize stated = sizeOf(board);
  std::vector<std::pair<ChessboardSize, std::string>>
      seen;  // a different size, and the photograph that shows it
  for (const std::string& photo : someOf(photos)) {
    const ChessboardSize size = largest(photo);
    if (size == stated) return;
    if (!isNone(size) && (isLarger(size, stated) || !shows(board, photo))) seen.emplace_back(size, photo);
  }
  // A part of a board may look like a smaller board. So takes the largest board seen twice, or in the only photograph
  // that shows one.
  std::optional<std::pair<ChessboardSize, std::string>> best;
  for (const auto& [size, photo] : seen) {
    const auto count = std::count_if(seen.begin(), seen.end(),
                                     [&, one = size](const auto& other) { return other.first == one; });
    if (count < 2 && seen.size() > 1) continue;
    if (!best || size.longer * size.shorter > best->first.longer * best->first.shorter) best = {size, photo};
  }
  if (!best) return;
  const std::string found = toString(chessboardOf(best->first, board));
  throw UserError(fmt::format(
      "{}: shows a chessboard of {} inner corners, not {}; count them where four squares meet, and give "
      "--board {}",
      best->second, found, toString(board), found));
}

std::string adviceOnSize(const Board& board) {
  if (board.kind != BoardKind::chessboard) return "check its size, and that it is that kind of board";
  return "count its inner corners, where four squares meet, and see whether all of them are in the "
         "photographs";
}

void requireWholeBoard(const Board& board, const std::vector<std::string>& photos) {
  constexpr std::size_t enough = 3;
  if (board.kind != BoardKind::chessboard || photos.empty()) return;
  ChessboardSize seen;
  for (std::size_t i = 0; i < std::min(enough, photos.size()); ++i) {
    const ChessboardSize size = largest(photos[i]);
    if (!isLarger(size, sizeOf(board))) return;
    if (i == 0 || isLarger(size, seen)) seen = size;
  }
  const std::string larger = toString(chessboardOf(seen, board));
  throw UserError(
      fmt::format("{}: the board has {} inner corners, more than {}, so it is unknown which of them are "
                  "meant; give --board {}",
                  photos.front(), larger, toString(board), larger));
}

}  // namespace slom::app::calib
