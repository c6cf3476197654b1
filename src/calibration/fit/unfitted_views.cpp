#include "calibration/fit/unfitted_views.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "calibration/fit/single_camera.hpp"
#include "calibration/median.hpp"

namespace slom::calibration {

std::vector<Stray> findStrays(const Dataset& data, const std::vector<Lens>& cameras, const RigStart& rig) {
  std::vector<Stray> views;
  std::vector<double> errors, medians;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (const View& view : data.cameras[c].views) {
      const SE3 world2camera = rig.left2camera[c] * rig.left2world.at(view.image).inverse();
      const double square = squaredPixelError(cameras[c], world2camera, view);
      errors.push_back(std::sqrt(square / double(view.corners.size())));
      medians.push_back(medianPixelError(cameras[c], world2camera, view));
      views.push_back({data.cameras[c].name, view.image, errors.back(), view.photo});
    }
  }
  const auto middle = errors.begin() + std::ptrdiff_t(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  const double limit = std::max(10.0, 10 * *middle);
  std::size_t i = 0;
  std::erase_if(views, [&](const Stray&) { return medians[i++] <= limit; });
  return views;
}

double usualRms(const Result& result, std::size_t camera) {
  std::vector<double> all;
  for (const ImageResult& image : result.images) {
    if (image.rms_px[camera]) all.push_back(*image.rms_px[camera]);
  }
  return medianOf(all);
}

void keepUnfitted(Result& result) {
  constexpr double much_worse = 3, least_px = 0.1;
  if (!result.success()) return;
  std::map<std::string, std::size_t> index_of;
  std::vector<double>
      usual_px;  // of a camera's views; at most that of the camera alone, because most views may contradict others
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    usual_px.push_back(std::fmax(least_px, std::fmin(usualRms(result, c), result.cameras[c].rms_px_single)));
    index_of[result.cameras[c].name] = c;
  }
  std::erase_if(result.strays, [&](const Stray& stray) {
    const std::size_t c = index_of.at(stray.camera);
    return std::any_of(result.images.begin(), result.images.end(), [&](const ImageResult& image) {
      return image.image == stray.image && image.rms_px[c] && *image.rms_px[c] <= much_worse * usual_px[c];
    });
  });
}

bool areMost(const std::vector<Stray>& strays, const Dataset& data) {
  return std::any_of(data.cameras.begin(), data.cameras.end(), [&](const CameraData& camera) {
    const auto own = std::count_if(strays.begin(), strays.end(),
                                   [&](const Stray& stray) { return stray.camera == camera.name; });
    return 2 * std::size_t(own) > camera.views.size();
  });
}

}  // namespace slom::calibration
