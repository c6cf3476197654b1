#include "calibrate/quality/residuals.hpp"

#include <algorithm>
#include <cmath>

namespace slom::app::calib {

std::vector<CornerResidual> residualsOf(const CameraData& data, const FittedRig& rig, std::size_t camera) {
  std::vector<CornerResidual> residuals;
  for (const View& view : data.views) {
    const SE3 world2camera = rig.left2camera[camera] * rig.left2world.at(view.image).inverse();
    for (const Corner& corner : view.corners) {
      const vec2 predicted = rig.lenses[camera]->project(world2camera * corner.world);
      residuals.push_back({view.image, corner.number, corner.line, corner.pixel, vec2(corner.pixel - predicted)});
    }
  }
  return residuals;
}

std::vector<WorstResidual> worstResiduals(const std::vector<CameraQuality>& cameras, std::size_t count) {
  std::vector<WorstResidual> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (const CornerResidual& corner : cameras[c].residuals) all.push_back({c, corner, corner.residual.norm()});
  }
  const auto end = all.begin() + std::ptrdiff_t(std::min(count, all.size()));
  std::partial_sort(all.begin(), end, all.end(),
                    [](const WorstResidual& a, const WorstResidual& b) { return a.error_px > b.error_px; });
  all.erase(end, all.end());
  return all;
}

ImageBox imageBoxOf(const CameraData& data, const CameraResult& camera) {
  if (data.image_size) return {data.image_size->width, data.image_size->height, false};
  vec2 most(2 * camera.camera_matrix(0, 2), 2 * camera.camera_matrix(1, 2));
  for (const View& view : data.views) {
    for (const Corner& corner : view.corners) most = vec2(most.cwiseMax(corner.pixel));
  }
  return {int(std::ceil(most.x())) + 1, int(std::ceil(most.y())) + 1, true};
}

double boardDistance(const std::map<int, Sight>& sights, const FittedRig& rig) {
  std::vector<double> distances;
  for (const auto& [image, sight] : sights) {
    const SE3 to_left = sight.left2world.inverse();
    for (std::size_t c = 0; c < sight.points.size(); ++c) {
      if (sight.points[c].empty()) continue;
      vec3 centre;
      for (const vec3& p : sight.points[c]) centre += p / double(sight.points[c].size());
      distances.push_back((rig.left2camera[c] * (to_left * centre)).norm());
    }
  }
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

}  // namespace slom::app::calib
