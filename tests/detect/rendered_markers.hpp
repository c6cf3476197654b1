// Pictures of ChArUco boards with the markers of OpenCV's dictionaries.
#pragma once

#include <string>
#include <vector>

#include <opencv2/aruco.hpp>

#include "detect/rendered_board.hpp"

namespace slom::app::calib::testing {

/// Bits of a marker, border and all, as the dictionary prints it: 0 or 1 by row and column.
inline std::vector<std::vector<int>> bitsOf(int dictionary, int id, int bits, int border) {
  cv::Mat drawn;
  const int side = bits + 2 * border;
  cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(dictionary), id, side, drawn, border);
  std::vector<std::vector<int>> result;
  for (int row = 0; row < side; ++row) {
    result.emplace_back();
    for (int column = 0; column < side; ++column) result.back().push_back(drawn.at<uchar>(row, column) > 0);
  }
  return result;
}

/// Draws squares from (0, 0) at the upper left. The first square is black, or white in a `legacy` board. Markers are in
/// the white squares, row by row. The corners of Board begin at the first inner corner.
inline Picture charucoPicture(const Board& board, int dictionary = cv::aruco::DICT_5X5_100, int bits = 5,
                              bool is_legacy = false) {
  std::vector<std::vector<std::vector<int>>> markers(std::size_t(board.columns * board.rows));
  int id = 0;
  for (int square = 0; square < board.columns * board.rows; ++square) {
    const bool is_white = (square % board.columns + square / board.columns) % 2 == (is_legacy ? 0 : 1);
    if (is_white) markers[std::size_t(square)] = bitsOf(dictionary, id++, bits, 1);
  }
  return [=](double x, double y) {
    const double u = x / board.square_m + 1, v = y / board.square_m + 1;
    const int column = int(std::floor(u)), row = int(std::floor(v));
    if (column < 0 || row < 0 || column >= board.columns || row >= board.rows) return 0.95;
    const auto& marker = markers[std::size_t(row * board.columns + column)];
    if (marker.empty()) return 0.05;
    const double margin = (1 - board.marker_m / board.square_m) / 2,
                 bit = board.marker_m / board.square_m / (bits + 2);
    const int i = int(std::floor((u - column - margin) / bit)), j = int(std::floor((v - row - margin) / bit));
    if (i < 0 || j < 0 || i > bits + 1 || j > bits + 1) return 0.95;
    return marker[std::size_t(j)][std::size_t(i)] ? 0.95 : 0.05;
  };
}

}  // namespace slom::app::calib::testing
