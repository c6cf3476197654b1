#include "calibrate/detect/chessboard.hpp"

#include <algorithm>
#include <cmath>

namespace slom::app::calib {
namespace {

/// `columns` x `rows` corners, row by row.
struct Grid {
  int columns, rows;
  std::vector<vec2> corners;

  const vec2& at(int column, int row) const { return corners[std::size_t(row) * columns + column]; }
};

/// Returns twice the area of the grid, positive if x and y of the board run as u and v do.
double area(const Grid& grid) {
  double sum = 0;
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const Eigen::Vector2d x = grid.at(column + 1, row) - grid.at(column, row);
      const Eigen::Vector2d y = grid.at(column, row + 1) - grid.at(column, row);
      sum += x.x() * y.y() - x.y() * y.x();
    }
  }
  return sum;
}

double brightness(const Photograph& photo, const Eigen::Vector2d& pixel) {
  const int u = std::clamp(int(std::lround(pixel.x())), 0, photo.size.width - 1);
  const int v = std::clamp(int(std::lround(pixel.y())), 0, photo.size.height - 1);
  return photo.grey[std::size_t(v) * photo.size.width + u];
}

/// Returns how much darker the first inner square, and all of its colour, are than the others.
double darknessOfFirst(const Grid& grid, const Photograph& photo) {
  double sum = 0;
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const Eigen::Vector2d centre = (grid.at(column, row) + grid.at(column + 1, row) +
                                      grid.at(column, row + 1) + grid.at(column + 1, row + 1)) /
                                     4;
      sum += ((column + row) % 2 == 0 ? -1 : 1) * brightness(photo, centre);
    }
  }
  return sum;
}

/// Returns the grid seen from its other end.
Grid halfTurned(Grid grid) {
  std::reverse(grid.corners.begin(), grid.corners.end());
  return grid;
}

/// Returns a square grid that begins at the end of the first row.
Grid quarterTurned(const Grid& grid) {
  Grid turned = grid;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column)
      turned.corners[std::size_t(row) * grid.columns + column] = grid.at(grid.columns - 1 - row, column);
  }
  return turned;
}

}  // namespace

std::vector<vec2> inBoardOrder(const Board& board, std::vector<vec2> corners, const Photograph& photo) {
  Grid grid{board.columns, board.rows, std::move(corners)};
  if (area(grid) < 0) {  // a board cannot be seen from behind
    for (int row = 0; row < grid.rows; ++row) {
      const auto begin = grid.corners.begin() + std::ptrdiff_t(row) * grid.columns;
      std::reverse(begin, begin + grid.columns);
    }
  }
  std::vector<Grid> turned{grid, halfTurned(grid)};
  if (board.columns == board.rows)
    turned.push_back(quarterTurned(turned[0])), turned.push_back(quarterTurned(turned[1]));
  const bool colours_decide =
      std::any_of(turned.begin(), turned.end(), [&](const Grid& g) { return darknessOfFirst(g, photo) > 0; });
  const auto rank = [&](const Grid& g) {
    const bool is_wrong = colours_decide && darknessOfFirst(g, photo) <= 0;
    return std::pair(is_wrong, g.corners[0].sum());
  };
  const auto best = std::min_element(turned.begin(), turned.end(),
                                     [&](const Grid& a, const Grid& b) { return rank(a) < rank(b); });
  return best->corners;
}

}  // namespace slom::app::calib
