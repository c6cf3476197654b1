// A ChArUco board whose size, dictionary or pattern was given wrongly: how its markers lie.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/detector.hpp"

namespace slom::app::calib {

/// A number of columns, which with the order of ids says where each marker lies: row by row in the squares of one colour.
struct MarkerLayout {
  int columns = 0, rows = 0;  ///< squares; rows: up to the last marker that was seen
  bool is_legacy =
      false;  ///< the square at the upper left is white, as OpenCV before 4.6 printed boards of an even number of rows
  double misfit = 0;  ///< of marker centres, the mean distance [squares]
};

/// The layout that explains the markers of all photographs best; columns 0: none does.
MarkerLayout likeliestLayout(const std::vector<std::vector<SeenMarker>>& photos);

/// How badly one layout explains them.
double misfitOf(const MarkerLayout& layout, const std::vector<std::vector<SeenMarker>>& photos);

/// A look at some photographs before the search in all: UserError when their markers lie otherwise than on this board, and on another one.
void requireLayoutLikely(const Board& board, const std::vector<std::string>& photos);

}  // namespace slom::app::calib
