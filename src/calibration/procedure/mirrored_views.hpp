// Views that show the board mirrored. Seen from the front of a flat board, all views have the same handedness.
#pragma once

#include <vector>

#include "slom/calibration/board.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The handedness in which a view shows the board.
enum class Handedness { unclear, right, left };

/// Returns the sign of the best affine map from the plane of the board to the image. The sign holds for lenses of any
/// width. Returns unclear if corners are off the plane, if the board is seen nearly edge-on, or if the corners are
/// far from the affine map.
Handedness handednessOf(const View& view, const BoardPlane& plane);

/// Returns the views whose handedness is that of a small minority of their camera, as Stray::is_left_out and
/// Stray::is_mirrored. Returns nothing if the other views do not suffice. Does not compare cameras with each other,
/// because a camera that looks through a mirror is right, too.
std::vector<Stray> mirroredViews(const Dataset& data);

/// Sets Stray::error_px of mirrored views and adds the views to the strays of a fit without them.
void addMirroredViews(std::vector<Stray> mirrored, const Dataset& data, Result& result);

}  // namespace slom::calibration
