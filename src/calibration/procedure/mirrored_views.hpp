// Views that show the board mirrored: from the front of a flat board, all views have the same handedness.
#pragma once

#include <vector>

#include "slom/calibration/board.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Which way round a view shows the board.
enum class Handedness { unclear, right, left };

/// Returns the sign of the best affine map from the plane of the board to the image. A lens of any width keeps the sign. It is unclear if corners are off
/// the plane, the board is seen nearly from its edge, or the corners are far from the affine map.
Handedness handednessOf(const View& view, const BoardPlane& plane);

/// Returns the views whose handedness is that of a small minority of their camera, as Stray::is_left_out and Stray::is_mirrored. Nothing if the other views
/// do not suffice. Cameras are not compared with each other: a lens with a mirror, too, is right.
std::vector<Stray> mirroredViews(const Dataset& data);

/// Sets Stray::error_px of mirrored views and adds them to the strays of a fit without them.
void addMirroredViews(std::vector<Stray> mirrored, const Dataset& data, Result& result);

}  // namespace slom::calibration
