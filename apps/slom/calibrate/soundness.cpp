#include "calibrate/soundness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "plausible.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

double rmsOf(const ImageResult& image) {
  double most = 0;
  for (const auto& rms : image.rms_px) most = std::max(most, rms.value_or(0));
  return most;
}

const ImageResult* worstImage(const Result& result) {
  const auto worst =
      std::max_element(result.images.begin(), result.images.end(),
                       [](const ImageResult& a, const ImageResult& b) { return rmsOf(a) < rmsOf(b); });
  return worst == result.images.end() ? nullptr : &*worst;
}

/// Returns a sentence about images that all have one other size than the rest; empty if that is not the case.
std::string otherSize(const Result& result) {
  const std::vector<Stray>& strays = result.strays;
  const bool is_one_size = std::all_of(strays.begin(), strays.end(), [&](const Stray& stray) {
    return stray.size != 1 && stray.size == strays.front().size && stray.camera == strays.front().camera;
  });
  if (!is_one_size) return "";
  std::vector<std::string> images, options;
  for (const Stray& stray : strays) {
    images.push_back(std::to_string(stray.image));
    options.push_back(result.cameras.size() == 1 ? fmt::format("--exclude {}", stray.image)
                                                 : fmt::format("--exclude {}.{}", stray.camera, stray.image));
  }
  const std::string size = strays.front().size == 0.5 ? "half the size"
                           : strays.front().size == 2
                               ? "twice the size"
                               : fmt::format("{:.3g} times the size", strays.front().size);
  const char* const are = strays.front().size == 0.5 ? (strays.size() == 1 ? "is" : "are")
                          : strays.size() == 1       ? "seems to be"
                                                     : "seem to be";  // a cropped image may look like it
  return fmt::format("{} {} of {} {} at {} of the others: pass {}, or scale {}",
                     strays.size() == 1 ? "image" : "images", listed(images, ", ", " and "),
                     strays.front().camera, are, size, fmt::join(options, " "),
                     strays.size() == 1 ? "it" : "them");
}

/// Returns one sentence about views that contradict the others; empty if there are none.
std::string contradiction(const Result& result) {
  constexpr std::size_t most = 5;
  if (result.strays.empty()) return "";
  if (const std::string sentence = otherSize(result); !sentence.empty()) return sentence;
  std::vector<std::string> names;
  double least = most_px, largest = 0;
  for (const Stray& stray : result.strays) {
    const double error = std::isfinite(stray.error_px) ? stray.error_px : most_px;
    least = std::min(least, error);
    largest = std::max(largest, error);
    if (names.size() < most) names.push_back(fmt::format("{}.{}", stray.camera, stray.image));
  }
  const std::size_t count = result.strays.size();
  const std::string errors[] = {fixedDecimals(least, 0), fixedDecimals(largest, 0)};
  const std::string by = errors[0] == errors[1] ? errors[0] : errors[0] + " to " + errors[1];
  const std::string all = count > most ? fmt::format("{} and {} more", fmt::join(names, ", "), count - most)
                                       : listed(names, ", ", " and ");
  const std::string& why = result.strays.front().why;
  const bool have_one_cause =
      !why.empty() && std::all_of(result.strays.begin(), result.strays.end(),
                                  [&](const Stray& stray) { return stray.why == why; });
  const bool is_mirrored = have_one_cause && result.strays.front().is_mirrored;
  const std::string fault = fmt::format(
      "{} the others{}{}",
      count == 1 ? fmt::format("image {} contradicts", all) : fmt::format("images {} contradict", all),
      is_mirrored ? "" : fmt::format(" by {} px", by), have_one_cause ? ": " + why : "");
  const char* const remedy = have_one_cause ? (count == 1 ? "correct it" : "correct them")
                                            : (count == 1 ? "correct its number" : "correct their numbers");
  return fmt::format("{}; {} or leave {} out by --exclude", fault, remedy, count == 1 ? "it" : "them");
}

/// Returns a distance of corners beyond any detection error: a number of px for images of up to 1280 px,
/// proportionally more for larger ones, and at least a number of stated sigmas.
double explainedPx(const Result& result) {
  constexpr double usual_px = 2, usual_side = 1280, sigmas = 6;
  double side = usual_side;
  for (const CameraResult& camera : result.cameras) {
    if (camera.image_size)
      side = std::max({side, double(camera.image_size->width), double(camera.image_size->height)});
  }
  return std::max(usual_px * side / usual_side, sigmas * result.sigma_px);
}

/// Returns a sentence about corners, of all images or of one, that are farther off than detection explains; empty if
/// there are none.
std::string misfit(const Result& result) {
  const double limit = explainedPx(result), rms = rmsOfAll(result);
  std::string fault;
  if (rms > limit) {
    fault = fmt::format("corners are {} px off (RMS)", twoDigits(rms));
  } else if (const ImageResult* worst = worstImage(result); worst && rmsOf(*worst) > 2 * limit) {
    fault = fmt::format("corners of image {} are {} px off (RMS)", worst->image, twoDigits(rmsOf(*worst)));
  }
  if (fault.empty()) return "";
  return fmt::format("{}, but detection explains only {} px; {}", fault, twoDigits(limit), causeText(result));
}

}  // namespace

std::string remedyOf(const ImuFinding& finding, const Result& result) {
  if (finding.kind != ImuFinding::Kind::handedness) return finding.remedy;
  return fmt::format(
      "check whether one or all of its axes have the wrong sign, or two are exchanged; if the sensor reports {}, {} --imu-reads gravity",
      result.imu->reads_gravity ? "the reaction to gravity" : "gravity itself",
      result.imu->reads_gravity ? "drop" : "pass");
}

std::string causeText(const Result& result) {
  if (result.better_model) {
    return fmt::format("{0} fits them to {1} px: pass --intrinsics {0}", result.better_model->name,
                       twoDigits(result.better_model->rms_px));
  }
  if (!result.causes.empty()) return result.causes.front();
  return "look at the worst images and corners";
}

Unsoundness unsoundnessOf(const Result& result) {
  if (!result.strays.empty()) return {"images contradict each other", contradiction(result)};
  if (result.success()) {
    if (const std::string sentence = misfit(result); !sentence.empty())
      return {"corners are too far off", sentence};
  }
  for (const ImuFinding& finding : imuFindings(result)) {
    if (finding.is_unusable)
      return {"the readings of the IMU cannot be right", finding.fault + "; " + remedyOf(finding, result)};
  }
  return {};
}

}  // namespace slom::app::calib
