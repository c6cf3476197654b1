#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "calibration/quality/verdict/doubts.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// Returns the first further view as a remedy. If the boards are nearly parallel, returns the first tilted view,
/// because a tilt is missing.
std::string remedyFor(const Result& result, const CameraQuality& camera) {
  const std::vector<FurtherView>& views = result.quality->further_views;
  const bool is_parallel = camera.tilt_spread < nearly_parallel;
  const auto view = std::find_if(views.begin(), views.end(), [&](const FurtherView& one) {
    return !is_parallel || !one.edge_away.empty();
  });
  if (view != views.end()) return "add " + placeOf(*view, result);
  return is_parallel ? "tilt the board by at least 30 degrees, about both axes"
                     : "add images of boards that reach the border";
}

/// Returns `, because its boards are nearly parallel, within 3.4 degrees of their mean`; empty if the boards are
/// tilted.
std::string causeOf(const CameraQuality& camera) {
  if (!(camera.tilt_spread < nearly_parallel)) return "";
  return fmt::format(", because its boards are nearly parallel, within {} degrees of their mean",
                     twoDigits(std::max(0.1, camera.tilt_spread * degrees)));
}

const ProjectionUncertainty* atInfinity(const CameraQuality& camera) {
  const auto map =
      std::find_if(camera.projection.begin(), camera.projection.end(),
                   [](const ProjectionUncertainty& one) { return !std::isfinite(one.distance_m); });
  return map == camera.projection.end() ? nullptr : &*map;
}

/// Returns the part of the image without rays of the lens [%].
double openPercent(const ProjectionUncertainty& map) {
  const auto open =
      std::count_if(map.std_px.begin(), map.std_px.end(), [](double s) { return !std::isfinite(s); });
  return open == 0 ? 0 : std::max(1.0, 100.0 * double(open) / double(map.std_px.size()));
}

/// Returns a sentence about pixels without a ray; empty if all have one.
std::string openRays(const Result& result, std::size_t c) {
  const double open = openPercent(result.quality->cameras[c].projection.front());
  if (open == 0) return "";
  return fmt::format(
      "the lens model of {} has no ray for {:.0f} % of its image: it folds over there, outside the "
      "corners",
      result.cameras[c].name, open);
}

/// Returns a sentence about one camera; empty if its projection is known wherever it has rays.
std::string openProjection(const Result& result, std::size_t c) {
  const CameraQuality& camera = result.quality->cameras[c];
  const std::string& name = result.cameras[c].name;
  const ProjectionUncertainty& near = camera.projection.front();
  const ProjectionUncertainty* const far = atInfinity(camera);
  if (camera.focal_std > most_focal_std)
    return fmt::format("the focal length of {} is known only to {} %{}; {}", name,
                       twoDigits(100 * camera.focal_std), causeOf(camera), remedyFor(result, camera));
  if (near.worst_px > worst_bearable_px) {
    const std::string cause = causeOf(camera);
    return fmt::format(
        "corners do not reach far enough into the image of {}, so its projection is uncertain by up to {} "
        "px{}",
        name, twoDigits(near.worst_px), cause.empty() ? "" : cause + "; " + remedyFor(result, camera));
  }
  if (far && far->worst_px > worst_bearable_px)
    return fmt::format("far behind the boards the projection of {} is uncertain by up to {} px{}; {}", name,
                       twoDigits(far->worst_px), causeOf(camera), remedyFor(result, camera));
  const double side = std::max(camera.grid.box.width, camera.grid.box.height);
  if (camera.centre_std_px > most_centre_std * side)
    return fmt::format("the image centre of {} is known only to {} px{}; {}", name,
                       twoDigits(camera.centre_std_px), causeOf(camera), remedyFor(result, camera));
  return "";
}

}  // namespace

void doubtProjection(const Result& result, std::vector<std::string>& doubts) {
  if (!result.quality->hasProjection()) return;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    for (std::string doubt : {openProjection(result, c), openRays(result, c)}) {
      if (!doubt.empty()) doubts.push_back(std::move(doubt));
    }
  }
}

}  // namespace slom::calibration
