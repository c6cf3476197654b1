#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/data/point_key.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/well_formed.hpp"
#include "calibration/side_by_side.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double equal_px = 0.005;
constexpr double cell_px = 2 * equal_px;
constexpr std::size_t fewest_equal = 4;

/// The views seen so far, indexed by board point and cell of the image of their corners.
class ViewIndex {
 public:
  struct Match {
    const View* view = nullptr;  ///< nullptr: none
    std::size_t equal = 0;
    double difference_px = 0;
  };

  /// Adds a view. `view` must stay where it is.
  void add(const View& view) {
    for (const Corner& corner : view.corners)
      corners_.emplace(keyOf(corner, cellOf(corner.pixel.x()), cellOf(corner.pixel.y())),
                       Entry{views_.size(), corner.pixel, &corner});
    views_.push_back(&view);
  }

  /// Returns the view that this one repeats. If there are several, returns the one with the most corners in common.
  Match repeatedBy(const View& view) const {
    std::unordered_map<std::size_t, Match> matches;
    for (const Corner& corner : view.corners) count(corner, matches);
    Match best;
    for (const auto& [number, match] : matches) {
      const std::size_t smaller = std::min(views_[number]->corners.size(), view.corners.size());
      if (match.equal < std::max(fewest_equal, smaller - smaller / 4)) continue;
      const bool is_earlier =
          best.view && match.equal == best.equal && views_[number]->image < best.view->image;
      if (match.equal > best.equal || is_earlier) best = {views_[number], match.equal, match.difference_px};
    }
    return best;
  }

 private:
  struct Entry {
    std::size_t view;
    vec2 pixel;
    const Corner* corner;
  };

  static std::int64_t cellOf(double pixel) { return std::int64_t(std::floor(pixel / cell_px)); }

  static std::uint64_t keyOf(const Corner& corner, std::int64_t column, std::int64_t row) {
    std::uint64_t key = 0;
    const auto mix = [&](std::uint64_t number) {
      key = (key ^ number) * 0x9E3779B97F4A7C15u;
      key ^= key >> 29;
    };
    for (const double coordinate : corner.world)
      mix(std::bit_cast<std::uint64_t>(coordinate + 0.0));  // no -0
    mix(std::uint64_t(column));
    mix(std::uint64_t(row));
    return key;
  }

  /// Adds the corner to the matches of all views that have it.
  void count(const Corner& corner, std::unordered_map<std::size_t, Match>& matches) const {
    const double u = corner.pixel.x(), v = corner.pixel.y();
    for (std::int64_t column = cellOf(u - equal_px); column <= cellOf(u + equal_px); ++column) {
      for (std::int64_t row = cellOf(v - equal_px); row <= cellOf(v + equal_px); ++row) {
        const auto [begin, end] = corners_.equal_range(keyOf(corner, column, row));
        for (auto known = begin; known != end; ++known) {
          const Entry& other = known->second;
          const double difference = (other.pixel - corner.pixel).norm();
          if (!(difference <= equal_px) || other.corner->world != corner.world) continue;
          Match& match = matches[other.view];
          ++match.equal;
          match.difference_px = std::max(match.difference_px, difference);
        }
      }
    }
  }

  std::unordered_multimap<std::uint64_t, Entry> corners_;
  std::vector<const View*> views_;
};

/// Returns the number of corners of `b` at points of the board that `a` has, too.
std::size_t commonCorners(const View& a, const View& b) {
  std::set<PointKey> points;
  for (const Corner& corner : a.corners) points.insert(keyOf(corner.world));
  return std::size_t(std::count_if(b.corners.begin(), b.corners.end(), [&](const Corner& corner) {
    return points.contains(keyOf(corner.world));
  }));
}

std::string nameOf(const View& view) {
  return view.photo.empty() ? fmt::format("image {}", view.image)
                            : fmt::format("image {} ({})", view.image, view.photo);
}

/// Throws if two cameras have the same photographs.
void requireDifferent(const CameraData& a, const CameraData& b) {
  ViewIndex index;
  for (const View& view : a.views) index.add(view);
  std::size_t repeated = 0, common = 0, repeated_in_common = 0;
  std::string first;
  for (const View& view : b.views) {
    const ViewIndex::Match match = index.repeatedBy(view);
    const bool is_common = a.find(view.image) != nullptr;
    common += is_common;
    if (!match.view) continue;
    repeated_in_common += is_common;
    if (repeated++ == 0)
      first = fmt::format("{} of {} is {} of {}", nameOf(view), b.name, nameOf(*match.view), a.name);
  }
  const std::size_t views = std::min(a.views.size(), b.views.size());
  if (2 * repeated <= views && 2 * repeated_in_common <= common) return;
  throw DataError(
      "slom.calibration.copies",
      fmt::format("cameras {} and {} have the same corners in {} of {} images: {}; these are photographs "
                  "of one camera, so correct the files of the other camera, or leave it out",
                  a.name, b.name, repeated, b.views.size(), first),
      b.name);
}

void leaveOutCopies(CameraData& camera) {
  ViewIndex index;
  std::vector<View> kept;
  kept.reserve(camera.views.size());  // the index points to its elements
  for (View& view : camera.views) {
    const ViewIndex::Match match = index.repeatedBy(view);
    if (match.view) {
      camera.copies.push_back({view.image, match.view->image, view.photo, match.view->photo,
                               commonCorners(view, *match.view), match.equal, match.difference_px});
    } else {
      kept.push_back(std::move(view));
      index.add(kept.back());
    }
  }
  camera.views = std::move(kept);
  if (camera.copies.empty() || camera.views.size() > 1) return;
  throw DataError(
      "slom.calibration.copies",
      fmt::format(
          "{}: all {} images of camera {} repeat {}, to within {:.3f} px; a copy is not a second measurement, so "
          "add images "
          "from other directions",
          nameOf(camera), camera.copies.size() + 1, camera.name, nameOf(camera.views.front()),
          std::max_element(camera.copies.begin(), camera.copies.end(),
                           [](const Copy& a, const Copy& b) { return a.difference_px < b.difference_px; })
              ->difference_px),
      camera.name);
}

/// Removes readings of images that no camera has now that copies are left out.
void leaveOutReadings(Dataset& data) {
  const std::vector<int> images = data.images();
  std::set<int> lost;
  for (CameraData& camera : data.cameras) {
    for (Copy& copy : camera.copies) {
      if (std::binary_search(images.begin(), images.end(), copy.image)) continue;
      lost.insert(copy.image);
      copy.has_reading = std::any_of(data.imu->readings.begin(), data.imu->readings.end(),
                                     [&](const ImuReading& reading) { return reading.image == copy.image; });
    }
  }
  std::erase_if(data.imu->readings, [&](const ImuReading& reading) { return lost.contains(reading.image); });
}

}  // namespace

void leaveOutCopies(Dataset& caller) {
  requireWellFormed(caller);
  Dataset data = caller;
  for (CameraData& camera : data.cameras) sortViews(camera);
  for (std::size_t a = 0; a < data.cameras.size(); ++a) {
    for (std::size_t b = a + 1; b < data.cameras.size(); ++b)
      requireDifferent(data.cameras[a], data.cameras[b]);
  }
  sideBySide(data.cameras.size(), [&](std::size_t c) { leaveOutCopies(data.cameras[c]); });
  if (data.imu) leaveOutReadings(data);
  for (std::size_t c = 0; c < data.cameras.size(); ++c)
    caller.cameras[c] = std::move(data.cameras[c]);  // at their index
  caller.imu = std::move(data.imu);
}

}  // namespace slom::calibration
