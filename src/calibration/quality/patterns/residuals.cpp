#include "calibration/quality/patterns/residuals.hpp"

#include <algorithm>
#include <cmath>

namespace slom::calibration {
std::vector<CornerResidual> residualsOf(const CameraData& data, const FittedRig& rig, std::size_t camera) {
  std::vector<CornerResidual> residuals;
  for (const View& view : data.views) {
    const SE3 world2camera = rig.left2camera[camera] * rig.left2world.at(view.image).inverse();
    for (const Corner& corner : view.corners) {
      const vec2 predicted = rig.lenses[camera].project(world2camera * corner.world);
      residuals.push_back(
          {view.image, corner.number, corner.line, corner.pixel, vec2(corner.pixel - predicted)});
    }
  }
  return residuals;
}

std::vector<WorstResidual> worstResiduals(const Dataset& data, const std::vector<CameraQuality>& cameras,
                                          std::size_t count) {
  std::vector<WorstResidual> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (const CornerResidual& corner : cameras[c].residuals)
      all.push_back({c, corner, corner.residual.norm(), {}});
  }
  const auto end = all.begin() + std::ptrdiff_t(std::min(count, all.size()));
  std::partial_sort(all.begin(), end, all.end(),
                    [](const WorstResidual& a, const WorstResidual& b) { return a.error_px > b.error_px; });
  all.erase(end, all.end());
  for (WorstResidual& worst : all) {
    const CameraData& camera = data.cameras[worst.camera];
    const View* view = camera.find(worst.corner.image);
    for (const Corner& corner : view->corners) {
      if (corner.number == worst.corner.corner && corner.line == worst.corner.line)
        worst.place = camera.place(*view, corner);
    }
  }
  return all;
}

double boardDistance(const std::map<int, Observation>& observations, const FittedRig& rig) {
  std::vector<double> distances;
  for (const auto& [image, observation] : observations) {
    const SE3 to_left = observation.left2world.inverse();
    for (std::size_t c = 0; c < observation.corners.size(); ++c) {
      const std::vector<Corner>& corners = observation.corners[c];
      if (corners.empty()) continue;
      vec3 centre;
      for (const Corner& corner : corners) centre += corner.world / double(corners.size());
      distances.push_back((rig.left2camera[c] * (to_left * centre)).norm());
    }
  }
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

}  // namespace slom::calibration
