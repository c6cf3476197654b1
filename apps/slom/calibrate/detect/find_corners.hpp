// From photographs to corners: many at once, in parallel.
#pragma once

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photos.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Finds the board in all photographs, one for each thread in memory at a time. Photographs without a board,
/// of another size than most of their camera, and those that cannot be read, are listed in CameraData::unused
/// and left out. UserError when no size is that of most, or none shows the board. `with_progress` draws a bar
/// on standard error where that is a terminal.
std::vector<CameraData> findCorners(const std::vector<CameraFile>& cameras,
                                    const std::vector<CameraPhotos>& photos, const Board& board,
                                    bool with_progress);

}  // namespace slom::app::calib
