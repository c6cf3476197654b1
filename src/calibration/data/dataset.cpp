#include "slom/calibration/dataset.hpp"

#include <algorithm>
#include <set>

namespace slom::calibration {

bool isPlausible(const ImageSize& size) {
  return size.width > 0 && size.height > 0 && size.width <= most_side_px && size.height <= most_side_px;
}

std::string nameOf(const CameraData& camera) {
  return camera.file.empty() ? "camera " + camera.name : camera.file;
}

std::size_t CameraData::cornerCount() const {
  std::size_t count = 0;
  for (const View& view : views) count += view.corners.size();
  return count;
}

const View* CameraData::find(int image) const {
  const auto view = std::lower_bound(views.begin(), views.end(), image,
                                     [](const View& v, int number) { return v.image < number; });
  if (view != views.end() && view->image == image) return &*view;
  const auto anywhere =
      std::find_if(views.begin(), views.end(), [&](const View& v) { return v.image == image; });
  return anywhere != views.end() ? &*anywhere : nullptr;
}

std::string CameraData::place(const View& view, const Corner& corner) const {
  if (corner.line == 0) return view.photo.empty() ? nameOf(*this) : view.photo;
  return (view.file.empty() ? nameOf(*this) : view.file) + ":" + std::to_string(corner.line);
}

std::string ImuData::place(std::size_t index) const {
  const int line = index < readings.size() ? readings[index].line : 0;
  if (line > 0) return (file.empty() ? "imu" : file) + ":" + std::to_string(line);
  const std::string reading = "imu.readings[" + std::to_string(index) + "]";
  return file.empty() ? reading : file + ", " + reading;
}

std::vector<int> Dataset::images() const {
  std::set<int> numbers;
  for (const CameraData& camera : cameras) {
    for (const View& view : camera.views) numbers.insert(view.image);
  }
  return {numbers.begin(), numbers.end()};
}

Dataset Dataset::withImages(const std::function<bool(int)>& is_wanted) const {
  Dataset part;
  part.cameras = cameras;
  for (CameraData& camera : part.cameras)
    std::erase_if(camera.views, [&](const View& view) { return !is_wanted(view.image); });
  return part;
}

}  // namespace slom::calibration
