#include "calibration/quality/patterns/residuals.hpp"

#include <algorithm>
#include <cmath>

namespace slom::calibration {
namespace {

constexpr double most_px = 1e6;  // limit of an assumed size

/// Usual sizes of cameras' images [px].
constexpr std::pair<int, int> usual_sizes[] = {
    {320, 240},   {640, 360},   {640, 400},   {640, 480},   {752, 480},   {800, 600},   {848, 480},
    {960, 540},   {1024, 768},  {1280, 720},  {1280, 800},  {1280, 960},  {1280, 1024}, {1440, 1080},
    {1600, 1200}, {1920, 1080}, {1920, 1200}, {2048, 1536}, {2448, 2048}, {2592, 1944}, {3264, 2448},
    {3840, 2160}, {4000, 3000}, {4032, 3024}, {4096, 3072}, {6000, 4000}};

}  // namespace

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

ImageBox imageBoxOf(const CameraData& data, const CameraResult& camera) {
  if (data.image_size) return {data.image_size->width, data.image_size->height, false};
  const vec2 amid(2 * camera.camera_matrix(0, 2), 2 * camera.camera_matrix(1, 2));
  vec2 needed(1., 1.);
  for (const View& view : data.views) {
    for (const Corner& corner : view.corners)
      needed = vec2(needed.cwiseMax(corner.pixel + Eigen::Vector2d::Ones()));
  }
  const vec2 most(needed.cwiseMax(amid).cwiseMin(most_px));
  ImageBox best{int(std::ceil(most.x())), int(std::ceil(most.y())), true};
  double nearest = 0.1;  // as a part of the size
  for (const auto& [long_side, short_side] : usual_sizes) {
    for (const auto& [width, height] : {std::pair(long_side, short_side), {short_side, long_side}}) {
      if (width < needed.x() || height < needed.y()) continue;
      const double distance = std::hypot(amid.x() / width - 1, amid.y() / height - 1);
      if (distance < nearest) nearest = distance, best = {width, height, true};
    }
  }
  return best;
}

double boardDistance(const std::map<int, Observation>& observations, const FittedRig& rig) {
  std::vector<double> distances;
  for (const auto& [image, observation] : observations) {
    const SE3 to_left = observation.left2world.inverse();
    for (std::size_t c = 0; c < observation.points.size(); ++c) {
      if (observation.points[c].empty()) continue;
      vec3 centre;
      for (const vec3& p : observation.points[c]) centre += p / double(observation.points[c].size());
      distances.push_back((rig.left2camera[c] * (to_left * centre)).norm());
    }
  }
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

}  // namespace slom::calibration
