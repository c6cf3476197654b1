// From photographs to corners, many photographs in parallel.
#pragma once

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photos.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Finds the board in all photographs. Each thread keeps one photograph in memory at a time. Photographs without a
/// board, with another size than most of their camera, and unreadable ones are listed in CameraData::unused and left
/// out. Throws UserError if no size is that of most, or if no photograph shows the board. `with_progress` draws a bar
/// on standard error if that is a terminal.
std::vector<CameraData> findCorners(const std::vector<CameraFile>& cameras,
                                    const std::vector<CameraPhotos>& photos, const Board& board,
                                    bool with_progress);

}  // namespace slom::app::calib
