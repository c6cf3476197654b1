// The true layout of a ChArUco board whose stated size, dictionary or pattern is wrong.
#pragma once

#include <string>
#include <vector>

#include "calibrate/detect/detector.hpp"

namespace slom::app::calib {

/// A number of columns. With the order of ids, it determines where each marker lies: row by row in the squares of one
/// colour.
struct MarkerLayout {
  int columns = 0, rows = 0;  ///< squares; rows: up to the last marker seen
  bool is_legacy =
      false;  ///< the upper left square is white, as OpenCV before 4.6 printed boards with an even number of rows
  double misfit = 0;  ///< mean distance of marker centres [squares]
};

/// Returns the layout that explains the markers of all photographs best; columns 0: none does.
MarkerLayout likeliestLayout(const std::vector<std::vector<SeenMarker>>& photos);

/// Returns how badly a layout explains the markers.
double misfitOf(const MarkerLayout& layout, const std::vector<std::vector<SeenMarker>>& photos);

/// Looks at some photographs before the search in all. Throws UserError if their markers contradict this board and
/// fit another one.
void requireLayoutLikely(const Board& board, const std::vector<std::string>& photos);

}  // namespace slom::app::calib
