#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibration/quality/verdict/doubts.hpp"
#include "calibration/text.hpp"
#include "slom/calibration/assess.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

void doubtStrays(const Result& result, std::vector<std::string>& doubts) {
  for (const Stray& stray : result.strays) {
    if (stray.is_mirrored) {
      doubts.push_back(
          fmt::format("image {} of camera {} shows the board mirrored", stray.image, stray.camera));
      continue;
    }
    doubts.push_back(fmt::format("image {} of camera {} contradicts the others by {} px", stray.image,
                                 stray.camera, fixedDecimals(stray.error_px, 0)));
  }
}

/// Returns the largest figure of all cameras, at one of the distances.
double largest(const Quality& quality, std::size_t map, double ProjectionUncertainty::*figure) {
  double most = 0;
  for (const CameraQuality& camera : quality.cameras) {
    if (map < camera.projection.size() && std::isfinite(camera.projection[map].*figure))
      most = std::max(most, camera.projection[map].*figure);
  }
  return most;
}

std::string failure(const Result& result) {
  const char* advice = "The values below must not be used.";
  if (!result.undetermined.empty()) {
    return fmt::format("The images do not determine all parameters: {}. {}", result.undetermined, advice);
  }
  return fmt::format("The calibration did not converge: {}. {}", result.stop_reason, advice);
}

/// Returns a clause on how well the projection is known, and where, as far as the assessment got.
std::string knownProjection(const Quality& quality) {
  if (!quality.hasProjection()) return "";
  std::string text = fmt::format(
      "; at the distance of the boards, {} m, the projection is known to {} px in the middle of the image and to {} px at "
      "the worst place",
      twoDigits(quality.cameras.front().projection.front().distance_m),
      twoDigits(largest(quality, 0, &ProjectionUncertainty::middle_px)),
      twoDigits(largest(quality, 0, &ProjectionUncertainty::worst_px)));
  if (quality.cameras.front().projection.size() > 1)
    text += fmt::format(", at infinity to {} px",
                        twoDigits(largest(quality, 1, &ProjectionUncertainty::worst_px)));
  return text;
}

/// Returns whether all parts of the quality fit the number of cameras of the result.
bool isOfSameRig(const Quality& quality, const Result& result) {
  const std::size_t cameras = result.cameras.size();
  const auto has_projection = [](const CameraQuality& camera) { return !camera.projection.empty(); };
  const auto is_there = [&](const auto& of_camera) { return of_camera.camera < cameras; };
  return quality.cameras.size() == cameras && quality.split_half.cameras.size() <= cameras &&
         (!quality.hasProjection() ||
          std::all_of(quality.cameras.begin(), quality.cameras.end(), has_projection)) &&
         std::all_of(quality.worst.begin(), quality.worst.end(), is_there) &&
         std::all_of(quality.patterns.begin(), quality.patterns.end(), is_there);
}

void requireQuality(const Result& result) {
  const auto refuse = [](const char* sentence, const char* subject) {
    throw DataError("slom.calibration.no-quality", sentence, subject);
  };
  if (result.cameras.empty() || result.images.empty())
    refuse("there is no verdict on a result without cameras or images; pass the result of calibrate()",
           "result");
  if (!result.quality)
    refuse(
        "there is no verdict on a result without an assessment; first set result.quality to assess(data, "
        "settings, result)",
        "quality");
  if (!isOfSameRig(*result.quality, result))
    refuse(
        "there is no verdict on a result with the assessment of another one; first set result.quality to "
        "assess(data, settings, result)",
        "quality");
}

}  // namespace

const char* toString(Verdict::Level level) {
  switch (level) {
    case Verdict::Level::trustworthy:
      return "trustworthy";
    case Verdict::Level::doubtful:
      return "doubtful";
    case Verdict::Level::failed:
      return "failed";
  }
  return "";
}

double rmsOfAll(const Result& result) {
  double squares = 0, corners = 0;
  for (const CameraResult& camera : result.cameras) {
    squares += camera.rms_px * camera.rms_px * double(camera.corners);
    corners += double(camera.corners);
  }
  return std::sqrt(squares / corners);
}

Verdict verdictOf(const Result& result) {
  Verdict verdict;
  doubtStrays(result, verdict.doubts);
  if (!result.success()) {
    verdict.sentence = failure(result);
    return verdict;
  }
  requireQuality(result);
  for (std::string& doubt : doubtsOf(result)) verdict.doubts.push_back(std::move(doubt));
  verdict.level = verdict.doubts.empty() ? Verdict::Level::trustworthy : Verdict::Level::doubtful;
  verdict.sentence = fmt::format("Calibrated to {} px with {}", fixedDecimals(rmsOfAll(result), 2),
                                 counted(result.images.size(), "image")) +
                     knownProjection(*result.quality);
  verdict.sentence += verdict.doubts.empty() ? "." : "; but " + verdict.doubts.front() + ".";
  return verdict;
}

}  // namespace slom::calibration
