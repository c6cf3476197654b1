// Whether the corners of a view agree among themselves, whatever the lens: from the board to the image leads a smooth map.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// How far most corners of a view are from the best smooth map.
struct ViewMisfit {
  double px =
      0;  ///< median distance, allowing for what the map's parameters follow [px]; 0 of views with fewer than 9 corners
  double extent_px = 0;  ///< root mean square distance of the corners from their mean [px]
  double part() const { return extent_px > 0 ? px / extent_px : 0; }
};

/// The better of a homography and of polynomials in the plane of the board, of degree 1 to 4 by the number of corners. A tenth of the corners, the
/// farthest off, does not count. Lenses up to 80 degrees off the axis leave less than 0.03 of the extent, beyond at most 0.1; corners that are numbered
/// in another order leave 0.13 and more.
ViewMisfit misfitOf(const View& view);

/// What corners that fit no smooth map fit instead, in most of these views, a clause with the number that shows it: `numbered by rows of 6 instead of 5
/// (rows and columns exchanged) they fit to 0.3 px`; empty: none of the usual mistakes.
std::string numberingThatFits(const std::vector<const View*>& views);

/// DataError [slom.calibration.bad-view] where the corners of nearly all views of a camera fit no smooth map.
void requireSmoothViews(const CameraData& camera);

}  // namespace slom::calibration
