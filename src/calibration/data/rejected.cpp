#include "calibration/data/rejected.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace slom::calibration {

Dataset withoutViews(Dataset data, const std::vector<Stray>& views) {
  for (CameraData& camera : data.cameras) {
    std::erase_if(camera.views, [&](const View& view) {
      return std::any_of(views.begin(), views.end(), [&](const Stray& one) {
        return one.camera == camera.name && one.image == view.image;
      });
    });
  }
  if (data.imu && !views.empty()) {
    const std::vector<int> images = data.images();
    std::erase_if(data.imu->readings, [&](const ImuReading& reading) {
      return !std::binary_search(images.begin(), images.end(), reading.image) &&
             std::any_of(views.begin(), views.end(),
                         [&](const Stray& one) { return one.image == reading.image; });
    });
  }
  return data;
}

Dataset withoutRejected(const Dataset& data, const Result& result) {
  std::vector<Stray> left_out;
  for (const Stray& stray : result.strays) {
    if (stray.is_left_out) left_out.push_back(stray);
  }
  Dataset rest = withoutViews(data, left_out);
  for (const GrossCorner& corner : result.rejected) {
    if (corner.camera >= rest.cameras.size()) continue;
    for (View& view : rest.cameras[corner.camera].views) {
      if (view.image == corner.image)
        std::erase_if(view.corners, [&](const Corner& one) { return one.number == corner.number; });
    }
  }
  return rest;
}

bool isLong(const Dataset& data) {
  constexpr std::size_t many = 300;  // views of a camera
  return std::all_of(data.cameras.begin(), data.cameras.end(),
                     [](const CameraData& camera) { return camera.views.size() > many; });
}

std::vector<GrossCorner> rejectable(const Dataset& data, const Result& result) {
  // In standard deviations. If a lens model is slightly too simple, good corners at the border of an image reach 6 or
  // 7.
  constexpr double beyond_doubt = 10;
  constexpr double of_the_worst =
      0.5;  // a gross corner pulls the fit towards it, so that other corners look worse than they are
  constexpr double most = 0.1;  // fraction of the corners of a view; beyond, the view itself is wrong
  using ViewKey = std::pair<std::size_t, int>;
  const bool is_long = isLong(data);
  std::map<ViewKey, int> gone;
  for (const GrossCorner& corner : result.rejected) ++gone[{corner.camera, corner.image}];
  std::map<ViewKey, double> worst_of_view;
  std::vector<GrossCorner> rejected;
  double worst = 0;
  for (const GrossCorner& corner : result.gross) {  // the worst first
    const ViewKey view(corner.camera, corner.image);
    const auto [first, is_first] = worst_of_view.emplace(view, corner.studentised);
    if (!is_first && !is_long) continue;
    if (corner.studentised < beyond_doubt || (!is_long && corner.studentised < of_the_worst * worst)) break;
    if (corner.studentised < of_the_worst * first->second) continue;
    if (gone[view] + 1 > most * double(data.cameras[corner.camera].find(corner.image)->corners.size()))
      continue;
    ++gone[view];
    worst = std::max(worst, corner.studentised);
    rejected.push_back(corner);
  }
  return rejected;
}

}  // namespace slom::calibration
