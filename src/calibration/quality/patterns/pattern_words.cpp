#include <array>
#include <cmath>

#include <fmt/format.h>

#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"
#include "slom/calibration/patterns.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {
namespace {

using Kind = ResidualPattern::Kind;

constexpr double by_chance = 0.005;  // probability
// Smaller patterns than these are significant in many images, too, but harmless.
constexpr double correlated = 0.1;
constexpr double part_of_points = 0.01;  // of the many points of the board
constexpr double part_of_places =
    0.002;  // the lens absorbs a part of such a pattern, which moves its parameters
constexpr double part_of_one_unknown = 0.001;  // moves a calibration by many of its standard deviations
constexpr double much_larger = 1.25;

std::string percent(double share) { return twoDigits(100 * share) + " %"; }

}  // namespace

bool ResidualPattern::isFound() const {
  if (!(probability <= by_chance)) return false;
  switch (kind) {
    case Kind::neighbours:
      return value >= correlated;
    case Kind::board_shape:
      return share >= part_of_points;
    case Kind::image_place:
      return share >= part_of_places;
    case Kind::drift:
    case Kind::row_readout:
    case Kind::time_offset:
      return share >= part_of_one_unknown;
    case Kind::motion_blur:
    case Kind::speed:
    case Kind::slant:
    case Kind::distance:
      return value >= much_larger;
  }
  return false;
}

const char* toString(Kind kind) {
  constexpr std::array names{"neighbours",  "board_shape", "image_place", "drift", "row_readout",
                             "time_offset", "motion_blur", "speed",       "slant", "distance"};
  return names[std::size_t(kind)];
}

std::string sentenceOf(const ResidualPattern& pattern, const Result& result) {
  if (pattern.camera >= result.cameras.size()) {
    throw DataError("slom.calibration.bad-question",
                    fmt::format("there is no camera {}; pass one of the patterns of this result's quality",
                                pattern.camera),
                    "pattern");
  }
  const std::string& camera = result.cameras[pattern.camera].name;
  const double value = pattern.value;
  const bool is_free = result.board && result.board->shape == BoardShape::free;
  switch (pattern.kind) {
    case Kind::neighbours:
      return fmt::format(
          "residuals of neighbouring corners in images of {} have a correlation of {}: they share errors, "
          "for example from blur, lighting or a lens model that is too simple, so many corners of an "
          "image count as a few independent ones",
          camera, fixedDecimals(value, 2));
    case Kind::board_shape:
      return fmt::format(
          "in all images of {}, the same corners of the board are displaced from their {} positions, by "
          "at least {} mm off the plane and {} mm within it (RMS), which explains {} of the squared "
          "residuals; {}",
          camera, result.board ? "fitted" : "stated", twoDigits(1e3 * value), twoDigits(1e3 * pattern.second),
          percent(pattern.share),
          is_free ? "the prior keeps the free board from following them: pass the noise that the residuals "
                    "show (--sigma-px), or a larger --sigma-board"
                  : "estimate the corners (--board-shape free), or lay the board on something flat and "
                    "measure the print");
    case Kind::image_place:
      return fmt::format(
          "residuals of {} depend on the place in the image by {} px (RMS), which explains {} of the "
          "squared residuals: the lens model does not fit, which also biases its parameters; {}",
          camera, twoDigits(value), percent(pattern.share),
          result.comparison
              ? "none of the compared models fits better, so name another one (--intrinsics), or look for "
                "moving optics, a window in front of the lens, or a board that bends"
              : "try another model (--compare)");
    case Kind::drift:
      return fmt::format(
          "the lens of {} changes over the images: {} by {} from the first to the last, which explains {} "
          "of the squared residuals; check whether the focus moved, the camera warmed up, or the lens "
          "model is too simple for images that change over time",
          camera, pattern.parameter, twoDigits(value), percent(pattern.share));
    case Kind::row_readout:
      return fmt::format(
          "residuals of {} follow the motion by row, as if the last row were read {} of the interval "
          "between image numbers after the first, which explains {} of the squared residuals: a rolling "
          "shutter; hold the camera still while it takes images, or estimate the time (--rolling-shutter)",
          camera, twoDigits(value), percent(pattern.share));
    case Kind::time_offset:
      return fmt::format(
          "residuals of {} follow the motion, as if it were {} of the interval between image numbers {} "
          "than {}, which explains {} of the squared residuals; check the time stamps, hold the cameras still "
          "while they take images, or, with an --imu-stream, add --camera-offsets",
          camera, twoDigits(std::abs(value)), value > 0 ? "later" : "earlier", result.cameras.front().name,
          percent(pattern.share));
    case Kind::motion_blur:
      return fmt::format(
          "in moving images of {}, residuals are {} times as large along the motion as across it, from "
          "blur or wrong time stamps; use a shorter exposure, or hold the camera still",
          camera, fixedDecimals(value, 1));
    case Kind::speed:
      return fmt::format(
          "residuals of {} are {} times as large in the fastest quarter of its images as in the slowest "
          "one, if image numbers are in the order of time; use a shorter exposure, or move more slowly",
          camera, fixedDecimals(value, 1));
    case Kind::slant:
      return fmt::format(
          "residuals of {} are {} times as large in the most slanted quarter of its images as in the most "
          "frontal one: corners are less exact there than the stated sigma",
          camera, fixedDecimals(value, 1));
    case Kind::distance:
      return fmt::format(
          "residuals of {} are {} times as large in the farthest quarter of its boards as in the nearest "
          "one: corners are less exact there than the stated sigma",
          camera, fixedDecimals(value, 1));
  }
  return "";
}

}  // namespace slom::calibration
