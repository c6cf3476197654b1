#include "calibrate/detect/detector_module.hpp"

#include "error.hpp"

namespace slom::app::calib {
namespace {

std::string complaint(const Board& board) {
  try {
    requireDetector(board);
  } catch (const UserError& error) {
    return error.what();
  }
  return {};
}

}  // namespace
}  // namespace slom::app::calib

const slom::app::calib::DetectorModule slom_detector_module{
    slom::app::calib::findBoard, slom::app::calib::showsChessboard, slom::app::calib::largestChessboard,
    slom::app::calib::seenMarkers, slom::app::calib::complaint};
