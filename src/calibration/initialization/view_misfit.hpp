// Whether the corners of a view are consistent for any lens: a smooth map leads from the board to the image.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// The distance of most corners of a view from the best smooth map.
struct ViewMisfit {
  /// Median distance, allowing for what the map's parameters absorb [px]; 0 for views with fewer than 9 corners.
  double px = 0;
  double extent_px = 0;  ///< root mean square distance of the corners from their mean [px]
  double part() const { return extent_px > 0 ? px / extent_px : 0; }
};

/// Fits a homography and polynomials in the plane of the board, of degree 1 to 4 by the number of corners, and
/// returns the better misfit. A tenth of the corners, the farthest off, does not count. Lenses up to 80 degrees off
/// the axis leave less than 0.03 of the extent, wider ones at most 0.1. Corners numbered in another order leave 0.13
/// and more.
ViewMisfit misfitOf(const View& view);

/// Returns a clause about a numbering that fits most of these views, with the remaining distance: `numbered in rows
/// of 6 instead of 5 (rows and columns are exchanged) they fit to 0.3 px`. Empty if none of the usual mistakes fits.
std::string numberingThatFits(const std::vector<const View*>& views);

/// Throws DataError [slom.calibration.bad-view] if the corners of nearly all views of a camera fit no smooth map.
void requireSmoothViews(const CameraData& camera);

}  // namespace slom::calibration
