// Replaces markers_aruco.cpp if OpenCV's module aruco was not found.
#include <fmt/format.h>

#include "calibrate/detect/markers.hpp"
#include "error.hpp"

namespace slom::app::calib {

std::vector<FoundCorner> findMarkers(const Board&, const Photograph&) { return {}; }

std::vector<SeenMarker> seenMarkers(const std::string&, const Photograph&) { return {}; }

void requireDictionary(const Board& board) {
  throw UserError(
      fmt::format("--board {}: this slom was built without OpenCV's markers; install libopencv-contrib-dev "
                  "and build slom "
                  "again, or use a chessboard",
                  toString(board)));
}

}  // namespace slom::app::calib
