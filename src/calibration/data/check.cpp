#include "calibration/data/check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "slom/calibration/board.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double world_line_tolerance =
    1e-4;  // relative to the size of the board; boards are known more exactly than this
constexpr double pixel_line_tolerance = 2e-3;  // 1 px over a board that fills 500 px
constexpr double plane_tolerance =
    0.05;  // relative to the size of the board; allows for bent boards, not for targets that are not flat

std::string firstPlace(const CameraData& camera) {
  return camera.place(camera.views.front(), camera.views.front().corners.front());
}

/// Throws if a point of the board has two pixels under one number, because at most one of them can be right.
void requireEachPointOnce(const CameraData& camera, const View& view) {
  std::map<std::tuple<int, double, double, double>, const Corner*> known;
  for (const Corner& corner : view.corners) {
    const vec3& p = corner.world;
    const auto [other, is_new] = known.emplace(std::tuple(corner.number, p.x(), p.y(), p.z()), &corner);
    if (is_new) continue;
    const vec2 &one = other->second->pixel, &two = corner.pixel;
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("{}: corner {} of image {} is there twice, at the pixels ({:.6g}, {:.6g}) and "
                    "({:.6g}, {:.6g}); remove one of the two",
                    camera.place(view, corner), corner.number, view.image, one.x(), one.y(), two.x(),
                    two.y()),
        camera.name);
  }
}

void checkView(const CameraData& camera, const View& view) {
  const std::string place = fmt::format("{}: image {}", camera.place(view, view.corners.front()), view.image);
  const std::size_t count = view.corners.size();
  if (count < 4) {
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("{} has only {} corner{}; a pose needs at least 4, so add corners or remove the image",
                    place, count, count == 1 ? "" : "s"),
        camera.name);
  }
  const BoardPlane plane = fitPlane(view.corners);
  std::vector<vec2> on_board, in_image;
  for (const Corner& corner : view.corners) {
    on_board.push_back(plane.coordinates(corner.world));
    in_image.push_back(corner.pixel);
  }
  if (onLineButOne(on_board, world_line_tolerance)) {
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("{}: all world points, or all but one, lie on a line; a pose needs at least two "
                    "points off the line, so add corners or remove the image",
                    place),
        camera.name);
  }
  if (onLineButOne(in_image, pixel_line_tolerance)) {
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("{}: all pixels, or all but one, lie on a line, as if the board were seen edge-on; "
                    "remove the image",
                    place),
        camera.name);
  }
  if (plane.thickness > plane_tolerance * plane.size) {
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("{}: the world points do not lie in a plane (they are off by {:.2g} m); the start "
                    "values need a flat board, so correct the points or remove the image",
                    place, plane.thickness),
        camera.name);
  }
}

/// Throws if a point of the board is twice at the same pixel, under two numbers: it was measured once.
void requireNoRepeatedCorner(const CameraData& camera, const View& view) {
  std::vector<const Corner*> corners;
  for (const Corner& corner : view.corners) corners.push_back(&corner);
  const auto place = [](const Corner& c) {
    return std::tuple(c.world.x(), c.world.y(), c.world.z(), c.pixel.x(), c.pixel.y(), c.line);
  };
  std::sort(corners.begin(), corners.end(),
            [&](const Corner* a, const Corner* b) { return place(*a) < place(*b); });
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Corner &one = *corners[i - 1], &other = *corners[i];
    if (one.world != other.world || one.pixel != other.pixel) continue;
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format(
            "{}: corner {} of image {} repeats corner {}{}, the same point of the board at the same pixel; "
            "remove one of the two{}",
            camera.place(view, other), other.number, view.image, one.number,
            one.line > 0 ? fmt::format(" of line {}", one.line) : "", one.line > 0 ? " rows" : ""),
        camera.name);
  }
}

}  // namespace

void checkViews(const CameraData& camera) {
  if (camera.views.empty())
    throw DataError("slom.calibration.too-few-views",
                    fmt::format("{}: has no corners; add some", nameOf(camera)), camera.name);
  for (const View& view : camera.views) {
    checkView(camera, view);
    requireNoRepeatedCorner(camera, view);
    requireEachPointOnce(camera, view);
  }
  if (camera.views.size() < 2) {
    throw DataError(
        "slom.calibration.too-few-views",
        fmt::format("{}: image {} is the only one of camera {}; its intrinsics need at least 2 images from "
                    "different directions, so add images",
                    firstPlace(camera), camera.views.front().image, camera.name),
        camera.name);
  }
}

void checkConnected(const Dataset& data) {
  std::set<int> reached;  // images of the cameras connected to the first one so far
  std::vector<bool> tied(data.cameras.size(), false);
  const auto shares = [&](const View& view) { return reached.empty() || reached.contains(view.image); };
  for (bool grew = true; grew;) {
    grew = false;
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      const auto& views = data.cameras[c].views;
      if (tied[c] || !std::any_of(views.begin(), views.end(), shares)) continue;
      tied[c] = grew = true;
      for (const View& view : views) reached.insert(view.image);
    }
  }
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    if (tied[c]) continue;
    const CameraData& camera = data.cameras[c];
    throw DataError(
        "slom.calibration.unconnected",
        fmt::format(
            "{}: no common images connect camera {} with camera {}, not even through other cameras; take "
            "images of the board with both at the same time, or calibrate them separately{}",
            firstPlace(camera), camera.name, data.cameras.front().name,
            camera.views.front().time_ns
                ? ". Cameras with clocks of their own need an --imu-stream and --camera-offsets"
                : ""),
        camera.name);
  }
}

bool isStillConnected(const Dataset& rest) {
  if (rest.imu && rest.imu->readings.empty()) return false;
  try {
    checkConnected(rest);
  } catch (const DataError&) {
    return false;
  }
  return true;
}

void checkImuImages(const Dataset& data) {
  if (!data.imu) return;
  const std::vector<int> images = data.images();
  for (std::size_t i = 0; i < data.imu->readings.size(); ++i) {
    const int image = data.imu->readings[i].image;
    if (std::binary_search(images.begin(), images.end(), image)) continue;
    throw DataError("slom.calibration.imu-images",
                    {.place = data.imu->place(i),
                     .fault = fmt::format("there are no corners of image {} in any camera", image),
                     .remedy = "correct the number, or leave the reading out"});
  }
}

void checkDataset(const Dataset& data) {
  for (const CameraData& camera : data.cameras) checkViews(camera);
  checkConnected(data);
  checkImuImages(data);
}

}  // namespace slom::calibration
