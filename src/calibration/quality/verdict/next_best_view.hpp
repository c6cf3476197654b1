// Which further image of the board would help most, found without taking it: for boards at places all over
// the images, at tilts and distances, the information of the corners that the cameras would see is added, and
// the worst projection uncertainty follows from the sum.
#pragma once

#include <optional>
#include <vector>

#include "calibration/quality/uncertainty/projection.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

struct FurtherViewOptions {
  int count = 3;
  double board_distance_m = 0;  ///< boards stand there or nearer
  std::optional<double> of_distance_m =
      {};  ///< where the projection uncertainty is looked at; nothing: there, too
  int grid_columns = 7, grid_rows = 5;
  Limits limits;
};

/// The best one, the best one when that is added, and so on. `view`: has all corners of the board. WorkEnded
/// when there is no time left for all.
std::vector<FurtherView> furtherViews(const FittedRig& rig, const Information& information, const View& view,
                                      const std::vector<ImageGrid>& grids, const FurtherViewOptions& options);

/// The worst projection uncertainty over all cameras at these points [px].
double worstStd(const ProjectedPoints& points, const Posterior& posterior);
ProjectedPoints pointsOfAllCameras(const FittedRig& rig, const std::vector<ImageGrid>& grids,
                                   double distance_m);

}  // namespace slom::calibration
