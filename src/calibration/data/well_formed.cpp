#include "calibration/data/well_formed.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns whether all |x_i| <= most; false for NaN, because comparisons with NaN are false.
template <class Vector>
bool isWithin(const Vector& x, double most) {
  return (x.array().abs() <= most).all();
}

template <class Vector>
std::string textOf(const Vector& x) {
  std::string text;
  for (const double number : x) text += fmt::format("{}{:.6g}", text.empty() ? "(" : ", ", number);
  return text + ")";
}

void requireNames(const Dataset& data) {
  std::map<std::string, std::size_t> index_of;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const std::string& name = data.cameras[c].name;
    if (name.empty()) {
      throw DataError("slom.calibration.bad-camera",
                      fmt::format("cameras[{}] has no name; give it one for results and messages", c),
                      fmt::format("cameras[{}]", c));
    }
    const auto [known, is_new] = index_of.emplace(name, c);
    if (is_new) continue;
    throw DataError("slom.calibration.bad-camera",
                    fmt::format("cameras[{}] and cameras[{}] are both called {}; give each camera a name of "
                                "its own",
                                known->second, c, name),
                    name);
  }
}

void requireImageSize(const CameraData& camera) {
  if (!camera.image_size || isPlausible(*camera.image_size)) return;
  throw DataError(
      "slom.calibration.bad-camera",
      fmt::format("the image size of camera {} is {} x {} px; give both sides from 1 to {} px, or "
                  "leave image_size empty",
                  camera.name, camera.image_size->width, camera.image_size->height, most_side_px),
      camera.name);
}

void requireImagesOnce(const CameraData& camera) {
  std::map<int, std::size_t> index_of;
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    const auto [known, is_new] = index_of.emplace(camera.views[v].image, v);
    if (is_new) continue;
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("camera {} has image {} twice, as views[{}] and views[{}]; put the corners of "
                    "an image into one view, or correct the number",
                    camera.name, camera.views[v].image, known->second, v),
        camera.name);
  }
}

/// Returns the place of a corner, if it comes from a file with lines or from a photograph, and its name.
std::string placeAndName(const CameraData& camera, const View& view, const Corner& corner) {
  const bool has_place = corner.line > 0 || !view.photo.empty() || !camera.file.empty();
  return (has_place ? camera.place(view, corner) + ": " : "") + nameOf(camera, view, corner);
}

[[noreturn]] void refuse(const CameraData& camera, const View& view, const Corner& corner,
                         const std::string& what, double most, const char* unit) {
  throw DataError(
      "slom.calibration.bad-corner",
      fmt::format("{} {}; give finite coordinates of magnitude {:g} {} at most, or remove the corner",
                  placeAndName(camera, view, corner), what, most, unit),
      camera.name);
}

/// Margin at the border. Pixel centres may have whole or half coordinates, and a detector may be off by a fraction of
/// a pixel.
constexpr double beyond_border_px = 1;

bool isInside(const vec2& pixel, double width, double height) {
  return pixel.x() >= -beyond_border_px && pixel.x() <= width + beyond_border_px &&
         pixel.y() >= -beyond_border_px && pixel.y() <= height + beyond_border_px;
}

/// Throws if more corners than a few gross ones lie outside the images: then the size is wrong.
void requireInside(const CameraData& camera) {
  constexpr double most_outside = 0.05;  // fraction of the corners
  const auto& [width, height] = *camera.image_size;
  const View* view = nullptr;
  const Corner* first = nullptr;
  std::size_t count = 0, swapped = 0;
  for (const View& one : camera.views) {
    for (const Corner& corner : one.corners) {
      swapped += !isInside(corner.pixel, height, width);
      if (isInside(corner.pixel, width, height) || count++ > 0) continue;
      view = &one;
      first = &corner;
    }
  }
  if (double(count) <= most_outside * double(camera.cornerCount())) return;
  throw DataError(
      "slom.calibration.bad-corner",
      fmt::format(
          "{} is at the pixel {}, outside the image of {} x {} px, like {} of {} corners{}; correct the "
          "size or the corners",
          placeAndName(camera, *view, *first), textOf(first->pixel), width, height, count,
          camera.cornerCount(), swapped == 0 ? " (are width and height exchanged?)" : ""),
      camera.name);
}

void requireCorners(const CameraData& camera, const View& view) {
  if (view.corners.empty()) {
    throw DataError("slom.calibration.bad-view",
                    fmt::format("image {} of camera {} has no corners; add at least 4, or remove the view",
                                view.image, camera.name),
                    camera.name);
  }
  for (const Corner& corner : view.corners) {
    if (!isWithin(corner.pixel, most_corner_px)) {
      refuse(camera, view, corner, fmt::format("is at the pixel {}", textOf(corner.pixel)), most_corner_px,
             "px");
    }
    if (!isWithin(corner.world, most_corner_m)) {
      refuse(camera, view, corner, fmt::format("is at {} m in the world", textOf(corner.world)),
             most_corner_m, "m");
    }
    if (corner.sigma >= least_corner_sigma && corner.sigma <= most_corner_sigma) continue;
    throw DataError(
        "slom.calibration.bad-corner",
        fmt::format("the sigma of {} is {:g} times Settings::sigma_px; give a number from {:g} to {:g}",
                    nameOf(camera, view, corner), corner.sigma, least_corner_sigma, most_corner_sigma),
        camera.name);
  }
}

void requireReadings(const ImuData& imu) {
  if (imu.readings.empty()) {
    throw DataError("slom.calibration.imu-open", {.place = imu.file.empty() ? "imu" : imu.file,
                                                  .fault = "there are no readings",
                                                  .remedy = "add some, or leave the IMU out"});
  }
  std::map<int, std::size_t> index_of;
  for (std::size_t i = 0; i < imu.readings.size(); ++i) {
    const ImuReading& reading = imu.readings[i];
    if (!isWithin(reading.acc, most_reading_m_s2)) {
      throw DataError(
          "slom.calibration.bad-reading",
          {.place = imu.place(i),
           .fault = fmt::format("the reading of image {} is {} m/s^2", reading.image, textOf(reading.acc)),
           .remedy = fmt::format("give finite numbers of magnitude {:g} m/s^2 at most, or leave the reading "
                                 "out",
                                 most_reading_m_s2)});
    }
    const auto [known, is_new] = index_of.emplace(reading.image, i);
    if (is_new) continue;
    throw DataError(
        "slom.calibration.bad-reading",
        {.place = imu.place(i),
         .fault = fmt::format("image {} already has a reading, {}", reading.image, imu.place(known->second)),
         .remedy = "keep one, or the mean of both"});
  }
}

}  // namespace

std::string nameOf(const CameraData& camera, const View& view, const Corner& corner) {
  const auto has_number = [&](const Corner& other) { return other.number == corner.number; };
  const bool is_unique = std::count_if(view.corners.begin(), view.corners.end(), has_number) == 1;
  return fmt::format("{} of image {} of camera {}",
                     is_unique ? fmt::format("corner {}", corner.number)
                               : fmt::format("corners[{}]", &corner - view.corners.data()),
                     view.image, camera.name);
}

void requireWellFormed(const Dataset& data) {
  requireNames(data);
  for (const CameraData& camera : data.cameras) {
    requireImageSize(camera);
    requireImagesOnce(camera);
    for (const View& view : camera.views) requireCorners(camera, view);
    if (camera.image_size) requireInside(camera);
  }
  if (data.imu) requireReadings(*data.imu);
}

}  // namespace slom::calibration
