// The further image of the board that would help most, found by calculation. Candidates are boards at places all over
// the images, at tilts and distances. The information of the corners that the cameras would see is added, and the
// worst projection uncertainty follows from the sum.
#pragma once

#include <optional>
#include <vector>

#include "calibration/quality/uncertainty/projection.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

struct FurtherViewOptions {
  int count = 3;
  double board_distance_m = 0;  ///< candidates are there or nearer
  std::optional<double> of_distance_m =
      {};  ///< where the projection uncertainty is looked at; nothing: there, too
  int grid_columns = 7, grid_rows = 5;
  Limits limits;
};

/// Selects views greedily: each is the best one, given those before it. `view` has all corners of the board. Throws
/// WorkEnded if the time does not suffice.
std::vector<FurtherView> furtherViews(const FittedRig& rig, const Information& information, const View& view,
                                      const std::vector<ImageGrid>& grids, const FurtherViewOptions& options);

/// Returns the worst projection uncertainty over all cameras at these points [px].
double worstStd(const ProjectedPoints& points, const Posterior& posterior);
ProjectedPoints pointsOfAllCameras(const FittedRig& rig, const std::vector<ImageGrid>& grids,
                                   double distance_m);

}  // namespace slom::calibration
