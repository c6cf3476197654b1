#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibration/text.hpp"
#include "slom/calibration/assess.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double far_off = 4;      // corner: distance over RMS, which noise exceeds once in 10^7 corners
constexpr double much_worse = 3;   // image: chi2 per measurement over the median
constexpr double too_noisy = 1.5;  // corners: observed over stated sigma
constexpr double halves_disagree = 1e-3;  // probability
constexpr double halves_differ = 1.5;     // over what noise gives
constexpr double worst_bearable_px = 3;
constexpr double much_more_than_stated = 2;  // clustered over stated standard deviations

double medianChi2(const Result& result) {
  std::vector<double> all;
  for (const ImageResult& image : result.images) all.push_back(image.chi2PerMeasurement());
  std::nth_element(all.begin(), all.begin() + all.size() / 2, all.end());
  return all[all.size() / 2];
}

void doubtCompleteness(const Quality& quality, std::vector<std::string>& doubts) {
  if (!quality.cut_short.empty())
    doubts.push_back(fmt::format("the assessment was cut short: {}", quality.cut_short));
}

void doubtStrays(const Result& result, std::vector<std::string>& doubts) {
  for (const Stray& stray : result.strays) {
    doubts.push_back(fmt::format("image {} of camera {} contradicts the others by {} px", stray.image,
                                 stray.camera, fixedDecimals(stray.error_px, 0)));
  }
}

void doubtImages(const Result& result, std::vector<std::string>& doubts) {
  const double limit = much_worse * std::max(medianChi2(result), 1e-12);
  for (const ImageResult* image : result.worstImages(3)) {
    if (image->chi2PerMeasurement() < limit) return;
    doubts.push_back(
        fmt::format("image {} should be looked at: its residuals are {} times the usual ones", image->image,
                    fixedDecimals(std::sqrt(image->chi2PerMeasurement() / medianChi2(result)), 1)));
  }
}

void doubtCorners(const Result& result, std::vector<std::string>& doubts) {
  int count = 0;
  for (const WorstResidual& worst : result.quality->worst) {
    const CameraResult& camera = result.cameras[worst.camera];
    if (worst.error_px < far_off * camera.rms_px || ++count > 3) return;
    doubts.push_back(fmt::format("corner {} of image {} of {} is {} px off", worst.corner.corner,
                                 worst.corner.image, camera.name, twoDigits(worst.error_px)));
  }
}

void doubtLeverage(const Result& result, std::vector<std::string>& doubts) {
  constexpr double hidden = 1.5;  // error without the corner over its residual
  int count = 0;
  for (const GrossCorner& corner : result.gross) {
    if (!(corner.error_without_px > hidden * corner.error_px)) continue;
    if (++count > 3) return;
    doubts.push_back(fmt::format(
        "corner {} of image {} of {} draws the fit to itself: without it, it is {} px off", corner.number,
        corner.image, result.cameras[corner.camera].name, twoDigits(corner.error_without_px)));
  }
}

void doubtNoise(const Result& result, std::vector<std::string>& doubts) {
  const double observed = std::sqrt(result.chi2PerDof());
  if (!(observed > too_noisy)) return;
  doubts.push_back(fmt::format(
      "the residuals are {} times what the stated sigmas allow, so all {} are too small by about that factor",
      fixedDecimals(observed, 1),
      result.quality->is_clustered ? "stated uncertainties" : "uncertainties here"));
}

void doubtIndependence(const Result& result, std::vector<std::string>& doubts) {
  if (!result.quality->is_clustered || result.clustered->levels_off ||
      !(result.clustered->ratio > much_more_than_stated))
    return;
  doubts.push_back(fmt::format(
      "errors last over many images, as by a drift or a model that is too simple, so that all uncertainties are rough, and {} "
      "times the stated ones",
      fixedDecimals(result.clustered->ratio, 1)));
}

void doubtHalves(const Result& result, std::vector<std::string>& doubts) {
  const SplitHalf& split = result.quality->split_half;
  // Where the residuals are larger than stated, so may the difference of the halves be.
  const double noise = std::max(1.0, std::sqrt(result.chi2PerDof()));
  for (std::size_t c = 0; c < split.cameras.size(); ++c) {
    const SplitHalfCamera& camera = split.cameras[c];
    if (!std::isfinite(camera.rms_px) || !std::isfinite(camera.expected_rms_px) ||
        !std::isfinite(camera.probability)) {
      doubts.push_back(fmt::format(
          "two halves of the images of {} cannot be compared, as one of them gives no usable lens",
          result.cameras[c].name));
      continue;
    }
    if (camera.probability > halves_disagree ||
        camera.rms_px < halves_differ * noise * camera.expected_rms_px)
      continue;
    doubts.push_back(
        fmt::format("two halves of the images of {} disagree by {} px where noise alone gives {} px",
                    result.cameras[c].name, twoDigits(camera.rms_px), twoDigits(camera.expected_rms_px)));
  }
}

/// What moves parameters in all images alike, which no standard deviation shows.
void doubtPatterns(const Result& result, std::vector<std::string>& doubts) {
  bool has_board = false;
  for (const ResidualPattern& pattern : result.quality->patterns) {
    if (!pattern.isFound()) continue;
    const std::string& camera = result.cameras[pattern.camera].name;
    switch (pattern.kind) {
      case ResidualPattern::Kind::board_shape:
        if (!std::exchange(has_board, true))
          doubts.push_back(fmt::format(
              "corners of the board are not where they are stated to be, by at least {} mm off its plane and {} mm within it",
              twoDigits(1e3 * pattern.value), twoDigits(1e3 * pattern.second)));
        break;
      case ResidualPattern::Kind::image_place:
        doubts.push_back(fmt::format("residuals of {} depend on the place in the image, by {} px", camera,
                                     twoDigits(pattern.value)));
        break;
      case ResidualPattern::Kind::drift:
        doubts.push_back(fmt::format("the lens of {} changes over the images", camera));
        break;
      case ResidualPattern::Kind::time_offset:
        doubts.push_back(fmt::format("{} and {} are not simultaneous", result.cameras.front().name, camera));
        break;
      default:
        break;
    }
  }
}

void doubtProjection(const Result& result, std::vector<std::string>& doubts) {
  if (!result.quality->hasProjection()) return;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const CameraQuality& camera = result.quality->cameras[c];
    const auto& std_px = camera.projection.front().std_px;
    const auto open = std::count_if(std_px.begin(), std_px.end(), [](double s) { return !std::isfinite(s); });
    if (open > 0) {
      doubts.push_back(
          fmt::format("the lens of {} folds over within the image, {:.0f} % of which no ray is known for",
                      result.cameras[c].name, std::max(1.0, 100.0 * double(open) / double(std_px.size()))));
    } else if (camera.projection.front().worst_px > worst_bearable_px) {
      doubts.push_back(
          fmt::format("corners do not reach far enough in the image of {}, so that its projection is "
                      "uncertain by up to {} px",
                      result.cameras[c].name, twoDigits(camera.projection.front().worst_px)));
    }
  }
}

/// The largest of all cameras.
double largest(const Quality& quality, double ProjectionUncertainty::*figure) {
  double most = 0;
  for (const CameraQuality& camera : quality.cameras) {
    if (std::isfinite(camera.projection.front().*figure))
      most = std::max(most, camera.projection.front().*figure);
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

/// How well the projection is known, as far as that was found out.
std::string knownProjection(const Quality& quality) {
  if (!quality.hasProjection()) return "";
  return fmt::format(
      "; the projection is known to {} px in the middle of the image and to {} px at the worst place",
      twoDigits(largest(quality, &ProjectionUncertainty::middle_px)),
      twoDigits(largest(quality, &ProjectionUncertainty::worst_px)));
}

/// Whether the quality is of as many cameras as the result, in all of its parts.
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
        "there is no verdict on a result without an assessment; set result.quality to assess(data, "
        "settings, result) before",
        "quality");
  if (!isOfSameRig(*result.quality, result))
    refuse(
        "there is no verdict on a result with the assessment of another one; set result.quality to "
        "assess(data, settings, result) before",
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
  doubtCompleteness(*result.quality, verdict.doubts);
  doubtImages(result, verdict.doubts);
  doubtCorners(result, verdict.doubts);
  doubtLeverage(result, verdict.doubts);
  doubtHalves(result, verdict.doubts);
  doubtNoise(result, verdict.doubts);
  doubtIndependence(result, verdict.doubts);
  doubtProjection(result, verdict.doubts);
  doubtPatterns(result, verdict.doubts);
  verdict.level = verdict.doubts.empty() ? Verdict::Level::trustworthy : Verdict::Level::doubtful;
  verdict.sentence = fmt::format("Calibrated to {} px with {}", fixedDecimals(rmsOfAll(result), 2),
                                 counted(result.images.size(), "image")) +
                     knownProjection(*result.quality);
  verdict.sentence += verdict.doubts.empty() ? "." : "; but " + verdict.doubts.front() + ".";
  return verdict;
}

}  // namespace slom::calibration
