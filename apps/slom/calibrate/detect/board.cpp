#include "calibrate/detect/board.hpp"

#include <fmt/format.h>

namespace slom::app::calib {

int Board::cornerColumns() const {
  return kind == BoardKind::charuco ? columns - 1 : kind == BoardKind::aprilgrid ? 2 * columns : columns;
}

int Board::cornerRows() const {
  return kind == BoardKind::charuco ? rows - 1 : kind == BoardKind::aprilgrid ? 2 * rows : rows;
}

vec3 Board::corner(int index) const {
  const int column = index % cornerColumns(), row = index / cornerColumns();
  if (is_asymmetric) return vec3((2 * column + row % 2) * square_m, row * square_m, 0.);
  if (row_m > 0) return vec3(column * square_m, row * row_m, 0.);
  const auto along = [&](int i) {
    if (kind != BoardKind::aprilgrid) return i * square_m;
    return (i / 2) * (1 + spacing) * square_m + (i % 2) * square_m;
  };
  return vec3(along(column), along(row), 0.);
}

int Board::symmetry() const {
  if (kind == BoardKind::circles) return is_asymmetric ? 1 : columns == rows ? 4 : 2;
  if (kind != BoardKind::chessboard || (columns + rows) % 2 == 1) return 1;
  return columns == rows && columns % 2 == 0 && row_m == 0 ? 4 : 2;
}

std::string toString(const Board& board) {
  const std::string size = fmt::format("{}x{}", board.columns, board.rows);
  switch (board.kind) {
    case BoardKind::charuco:
      return "charuco:" + size + ":" + board.dictionary;
    case BoardKind::aprilgrid:
      return "aprilgrid:" + size;
    case BoardKind::circles:
      return "circles:" + size;
    case BoardKind::chessboard:
      break;
  }
  return size;
}

}  // namespace slom::app::calib
