#include "calibration/data/image_box.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slom::calibration {
namespace {

constexpr double most_px = 1e6;  // limit of an assumed size

/// Common sizes of camera images [px].
constexpr std::pair<int, int> usual_sizes[] = {
    {320, 240},   {640, 360},   {640, 400},   {640, 480},   {752, 480},   {800, 600},   {848, 480},
    {960, 540},   {1024, 768},  {1280, 720},  {1280, 800},  {1280, 960},  {1280, 1024}, {1440, 1080},
    {1600, 1200}, {1920, 1080}, {1920, 1200}, {2048, 1536}, {2448, 2048}, {2592, 1944}, {3264, 2448},
    {3840, 2160}, {4000, 3000}, {4032, 3024}, {4096, 3072}, {6000, 4000}};

}  // namespace

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
  double nearest = 0.1;  // relative to the size
  for (const auto& [long_side, short_side] : usual_sizes) {
    for (const auto& [width, height] : {std::pair(long_side, short_side), {short_side, long_side}}) {
      if (width < needed.x() || height < needed.y()) continue;
      const double distance = std::hypot(amid.x() / width - 1, amid.y() / height - 1);
      if (distance < nearest) nearest = distance, best = {width, height, true};
    }
  }
  return best;
}

}  // namespace slom::calibration
