// The functions of detector.hpp as the shared object that was linked with OpenCV hands them over. To load
// OpenCV and its dependencies takes longer than to calibrate from corners, so it is loaded where there are
// photographs, and not before.
#pragma once

#include <filesystem>
#include <string>

#include "calibrate/detect/detector.hpp"

namespace slom::app::calib {

/// The one place of libslom_detect.so for the program of this absolute path: where the build put it when the
/// program is of the build tree, otherwise where installation puts it. Found nowhere else, so that nobody can
/// slip in another one. UserError where the path is not known, or its folder has not the name of the
/// installed one.
std::filesystem::path detectorFile(const std::filesystem::path& program);

/// UserError unless the library belongs to root or to the owner of the program, and others may not write it.
void requireTrusted(const std::filesystem::path& library, const std::filesystem::path& program);

struct DetectorModule {
  std::vector<FoundCorner> (*find_board)(const Board& board, const Photograph& photo);
  bool (*shows_chessboard)(const Board& board, const Photograph& photo);
  ChessboardSize (*largest_chessboard)(const Photograph& photo);
  std::vector<SeenMarker> (*seen_markers)(const std::string& dictionary, const Photograph& photo);
  std::string (*complaint)(const Board& board);  ///< what requireDetector throws; empty: nothing
};

}  // namespace slom::app::calib

/// In libslom_detect.so.
extern "C" __attribute__((visibility("default"))) const slom::app::calib::DetectorModule slom_detector_module;
