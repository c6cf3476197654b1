#include "calibration/data/sorted.hpp"

#include <algorithm>

namespace slom::calibration {
namespace {

bool isBefore(const View& a, const View& b) { return a.image < b.image; }

bool isSorted(const CameraData& camera) {
  return std::is_sorted(camera.views.begin(), camera.views.end(), isBefore);
}

}  // namespace

void sortViews(CameraData& camera) {
  if (!isSorted(camera)) std::sort(camera.views.begin(), camera.views.end(), isBefore);
}

SortedDataset::SortedDataset(const Dataset& data) : data_(&data) {
  if (std::all_of(data.cameras.begin(), data.cameras.end(), isSorted)) return;
  copy_ = data;
  for (CameraData& camera : copy_->cameras) sortViews(camera);
}

const CameraData& SortedDataset::ofCaller(const CameraData& camera) const {
  return data_->cameras[std::size_t(&camera - (**this).cameras.data())];
}

}  // namespace slom::calibration
