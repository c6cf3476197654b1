// Replaces detector_loaded.cpp and photograph_stb.cpp if OpenCV or stb was not found.
#include "calibrate/detect/detector.hpp"
#include "calibrate/detect/photo_patch.hpp"
#include "error.hpp"

namespace slom::app::calib {

std::optional<Photograph> readPhotograph(const std::string&, std::string&) { return {}; }

std::string photoPatch(const std::string&, const vec2&, int, int) { return {}; }

std::vector<FoundCorner> findBoard(const Board&, const Photograph&) { return {}; }

bool showsChessboard(const Board&, const Photograph&) { return false; }

ChessboardSize largestChessboard(const Photograph&) { return {}; }

std::vector<SeenMarker> seenMarkers(const std::string&, const Photograph&) { return {}; }

void requireDetector(const Board&) {
  throw UserError(
      "--images: this slom was built without OpenCV; install libopencv-calib3d-dev and libstb-dev and build "
      "slom again, "
      "or give the corners by --camera NAME=FILE");
}

}  // namespace slom::app::calib
