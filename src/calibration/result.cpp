#include "slom/calibration/result.hpp"

#include <algorithm>
#include <utility>

namespace slom::calibration {

std::vector<const ImageResult*> Result::worstImages(std::size_t count) const {
  std::vector<const ImageResult*> order;
  for (const ImageResult& image : images) order.push_back(&image);
  std::stable_sort(order.begin(), order.end(), [](const ImageResult* a, const ImageResult* b) {
    return a->chi2PerMeasurement() > b->chi2PerMeasurement();
  });
  order.resize(std::min(count, order.size()));
  return order;
}

void Result::declareUndetermined(std::string why) {
  undetermined = std::move(why);
  for (CameraResult& camera : cameras) {
    for (Parameter& parameter : camera.parameters) parameter.std = unknown;
    camera.translation_std = camera.rotation_std = camera.rotation_vector_std =
        vec3(unknown, unknown, unknown);
  }
  if (board) {
    for (MovedCorner& corner : board->corners) corner.std = vec3(unknown, unknown, unknown);
  }
  if (!imu) return;
  imu->rotation_std = imu->rotation_vector_std = imu->acc_bias_std = vec3(unknown, unknown, unknown);
  imu->gravity_std = unknown;
}

}  // namespace slom::calibration
