#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns the three of `numbers` nearest to `wanted`, ascending.
std::vector<int> nearest(std::vector<int> numbers, int wanted) {
  constexpr std::size_t most = 3;
  std::stable_sort(numbers.begin(), numbers.end(),
                   [&](int a, int b) { return std::abs(double(a) - wanted) < std::abs(double(b) - wanted); });
  numbers.resize(std::min(most, numbers.size()));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

/// Returns `17`, `17:5` or `left.17:5`.
std::string nameOf(const Exclusion& exclusion) {
  return fmt::format("{}{}{}{}", exclusion.camera, exclusion.camera.empty() ? "" : ".", exclusion.image,
                     exclusion.corner ? fmt::format(":{}", *exclusion.corner) : "");
}

[[noreturn]] void refuseExclusion(const Exclusion& exclusion, const std::string& fault,
                                  const std::string& remedy) {
  throw DataError("slom.calibration.nothing-to-exclude",
                  {.place = "exclusion " + nameOf(exclusion), .fault = fault, .remedy = remedy});
}

bool isMeant(const Exclusion& exclusion, const CameraData& camera) {
  return exclusion.camera.empty() || exclusion.camera == camera.name;
}

std::string nearestText(const std::vector<int>& numbers, int wanted) {
  return fmt::format("the nearest are {}", fmt::join(nearest(numbers, wanted), ", "));
}

void requireImage(const Dataset& data, const Exclusion& exclusion) {
  std::vector<std::string> names;
  std::vector<int> images;
  std::size_t meant = 0, having = 0;
  for (const CameraData& camera : data.cameras) {
    names.push_back(camera.name);
    if (!isMeant(exclusion, camera)) continue;
    ++meant;
    for (const View& view : camera.views) images.push_back(view.image);
    having += camera.find(exclusion.image) ? 1 : 0;
  }
  if (meant == 0)
    refuseExclusion(exclusion, fmt::format("there is no camera {}", exclusion.camera),
                    fmt::format("name one of {}", fmt::join(names, ", ")));
  std::sort(images.begin(), images.end());
  images.erase(std::unique(images.begin(), images.end()), images.end());
  if (having == 0)
    refuseExclusion(exclusion,
                    fmt::format("{} no image {}", exclusion.camera.empty() ? "there is" : "that camera has",
                                exclusion.image),
                    images.empty() ? "leave it out" : nearestText(images, exclusion.image));
  if (having > 1 && exclusion.corner)
    refuseExclusion(exclusion, "several cameras have that image, and each numbers corners in its own way",
                    fmt::format("name the camera, as in {}.{}", names.front(), nameOf(exclusion)));
}

/// Throws if earlier exclusions have removed the image or corner from all cameras that the exclusion names.
void requireNotGone(const Dataset& rest, const Exclusion& exclusion) {
  for (const CameraData& camera : rest.cameras) {
    const auto is_gone = [&](const Exclusion& one) {
      return one.image == exclusion.image && (!one.corner || one.corner == exclusion.corner);
    };
    if (isMeant(exclusion, camera) && camera.find(exclusion.image) &&
        std::none_of(camera.excluded.begin(), camera.excluded.end(), is_gone))
      return;
  }
  refuseExclusion(exclusion, "another exclusion already leaves that out", "give one of the two");
}

void excludeFrom(CameraData& camera, const Exclusion& exclusion) {
  const auto view = std::find_if(camera.views.begin(), camera.views.end(),
                                 [&](const View& one) { return one.image == exclusion.image; });
  if (view == camera.views.end()) return;
  if (!exclusion.corner) {
    camera.views.erase(view);
  } else {
    std::vector<int> numbers;
    for (const Corner& corner : view->corners) numbers.push_back(corner.number);
    const auto removed = std::erase_if(
        view->corners, [&](const Corner& corner) { return corner.number == *exclusion.corner; });
    if (removed == 0)
      refuseExclusion(exclusion,
                      fmt::format("image {} of camera {} has no corner {}", exclusion.image, camera.name,
                                  *exclusion.corner),
                      nearestText(numbers, *exclusion.corner));
  }
  camera.excluded.push_back({camera.name, exclusion.image, exclusion.corner});
}

}  // namespace

void exclude(Dataset& data, const std::vector<Exclusion>& exclusions) {
  Dataset rest = data;
  for (const Exclusion& exclusion : exclusions) {
    requireImage(data, exclusion);
    requireNotGone(rest, exclusion);
    for (CameraData& camera : rest.cameras) {
      if (isMeant(exclusion, camera)) excludeFrom(camera, exclusion);
    }
  }
  if (rest.imu) {
    std::set<int> images;
    for (const CameraData& camera : rest.cameras) {
      for (const View& view : camera.views) images.insert(view.image);
    }
    std::erase_if(rest.imu->readings, [&](const ImuReading& reading) {
      return std::any_of(exclusions.begin(), exclusions.end(),
                         [&](const Exclusion& one) { return one.image == reading.image; }) &&
             !images.contains(reading.image);
    });
  }
  data = std::move(rest);
}

}  // namespace slom::calibration
