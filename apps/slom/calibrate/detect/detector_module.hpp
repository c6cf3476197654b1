// The functions of detector.hpp, as the shared object linked with OpenCV provides them. Loading OpenCV and its
// dependencies takes longer than calibrating from corners, so it is loaded only if there are photographs.
#pragma once

#include <filesystem>
#include <string>

#include "calibrate/detect/detector.hpp"

namespace slom::app::calib {

/// Returns the only place of libslom_detect.so for the program with this absolute path. In the build tree it is the
/// place of the build, otherwise that of the installation. No other place is searched, so that nobody can slip in
/// another library. Throws UserError if the path is unknown, or if its folder does not have the name of the installed
/// one.
std::filesystem::path detectorFile(const std::filesystem::path& program);

/// Throws UserError unless the library belongs to root or to the owner of the program, and others cannot write it.
void requireTrusted(const std::filesystem::path& library, const std::filesystem::path& program);

struct DetectorModule {
  std::vector<FoundCorner> (*find_board)(const Board& board, const Photograph& photo);
  bool (*shows_chessboard)(const Board& board, const Photograph& photo);
  ChessboardSize (*largest_chessboard)(const Photograph& photo);
  std::vector<SeenMarker> (*seen_markers)(const std::string& dictionary, const Photograph& photo);
  std::string (*complaint)(const Board& board);  ///< text that requireDetector throws; empty: none
};

}  // namespace slom::app::calib

/// Exported by libslom_detect.so.
extern "C" __attribute__((visibility("default"))) const slom::app::calib::DetectorModule slom_detector_module;
