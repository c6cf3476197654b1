#include "calibration/quality/verdict/doubts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "slom/calibration/assess.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double far_off = 4;             // corner: distance over RMS; noise exceeds it once in 10^7 corners
constexpr double much_worse = 3;          // image: chi2 per measurement over the median
constexpr double too_noisy = 1.5;         // corners: observed sigma over stated sigma
constexpr double halves_disagree = 1e-3;  // probability
constexpr double halves_differ = 1.5;     // RMS over what noise gives
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

void doubtImages(const Result& result, std::vector<std::string>& doubts) {
  const double limit = much_worse * std::max(medianChi2(result), 1e-12);
  for (const ImageResult* image : result.worstImages(3)) {
    if (image->chi2PerMeasurement() < limit) return;
    doubts.push_back(
        fmt::format("the residuals of image {} are {} times the usual ones; check the image", image->image,
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
        "corner {} of image {} of {} pulls the fit towards it: in a fit without it, it is {} px off",
        corner.number, corner.image, result.cameras[corner.camera].name, twoDigits(corner.error_without_px)));
  }
}

void doubtNoise(const Result& result, std::vector<std::string>& doubts) {
  const double observed = std::sqrt(result.chi2PerDof());
  if (!(observed > too_noisy)) return;
  doubts.push_back(fmt::format(
      "the residuals are {} times as large as the stated sigmas predict, so all {} are too small by about "
      "that factor",
      fixedDecimals(observed, 1),
      result.quality->is_clustered ? "stated uncertainties" : "uncertainties here"));
}

void doubtIndependence(const Result& result, std::vector<std::string>& doubts) {
  if (!result.quality->is_clustered || result.clustered->levels_off ||
      !(result.clustered->ratio > much_more_than_stated))
    return;
  doubts.push_back(fmt::format(
      "errors last over many images, for example by a drift or a model that is too simple, so all "
      "uncertainties are rough, at {} times the stated ones",
      fixedDecimals(result.clustered->ratio, 1)));
}

/// Adds errors that move parameters in all images alike. No standard deviation shows them.
void doubtPatterns(const Result& result, std::vector<std::string>& doubts) {
  bool has_board = false;
  for (const ResidualPattern& pattern : result.quality->patterns) {
    if (!pattern.isFound()) continue;
    const std::string& camera = result.cameras[pattern.camera].name;
    switch (pattern.kind) {
      case ResidualPattern::Kind::board_shape:
        if (!std::exchange(has_board, true))
          doubts.push_back(fmt::format(
              "corners of the board are displaced from their stated positions, by at least {} mm off the "
              "plane and {} mm within it",
              twoDigits(1e3 * pattern.value), twoDigits(1e3 * pattern.second)));
        break;
      case ResidualPattern::Kind::image_place:
        doubts.push_back(fmt::format("residuals of {} depend on the place in the image, by {} px", camera,
                                     twoDigits(pattern.value)));
        break;
      case ResidualPattern::Kind::drift:
        doubts.push_back(fmt::format("the lens of {} changes over the images", camera));
        break;
      default:
        break;
    }
  }
}

void doubtImu(const Result& result, std::vector<std::string>& doubts) {
  for (const ImuFinding& finding : imuFindings(result)) {
    if (finding.is_doubt) doubts.push_back(finding.fault + "; " + finding.remedy);
  }
}

}  // namespace

bool isExplained(const ResidualPattern& pattern, const Result& result) {
  using Kind = ResidualPattern::Kind;
  const auto has = [&](const auto& isCause) {
    const auto& all = result.quality->patterns;
    return std::any_of(all.begin(), all.end(),
                       [&](const auto& one) { return one.isFound() && isCause(one); });
  };
  if (pattern.kind == Kind::row_readout)
    return has([&](const ResidualPattern& other) {
      return other.kind == Kind::time_offset && other.share >= pattern.share;
    });
  if (pattern.kind == Kind::motion_blur || pattern.kind == Kind::speed)
    return has([](const ResidualPattern& other) {
      return other.kind == Kind::time_offset || other.kind == Kind::row_readout;
    });
  return false;
}

void doubtTimes(const Result& result, std::vector<std::string>& doubts) {
  for (const ResidualPattern& pattern : result.quality->patterns) {
    if (!pattern.isFound() || isExplained(pattern, result)) continue;
    const std::string& camera = result.cameras[pattern.camera].name;
    if (pattern.kind == ResidualPattern::Kind::row_readout)
      doubts.push_back(
          fmt::format("the rows of {} seem to be read one after the other while it moves", camera));
    if (pattern.kind == ResidualPattern::Kind::time_offset)
      doubts.push_back(fmt::format("the images of {} and {} are not taken at the same time",
                                   result.cameras.front().name, camera));
  }
}

void doubtHalves(const Result& result, std::vector<std::string>& doubts) {
  const SplitHalf& split = result.quality->split_half;
  if (!split.why_not.empty() && result.quality->cut_short.empty())
    doubts.push_back("two halves of the images cannot be compared: " + split.why_not);
  // Larger residuals than stated also allow for a larger difference of the halves.
  const double noise = std::max(1.0, std::sqrt(result.chi2PerDof()));
  for (std::size_t c = 0; c < split.cameras.size(); ++c) {
    const SplitHalfCamera& camera = split.cameras[c];
    if (!std::isfinite(camera.rms_px) || !std::isfinite(camera.expected_rms_px) ||
        !std::isfinite(camera.probability)) {
      doubts.push_back(fmt::format(
          "two halves of the images of {} cannot be compared, because one of them gives no usable lens",
          result.cameras[c].name));
      continue;
    }
    if (camera.probability > halves_disagree ||
        camera.rms_px < halves_differ * noise * camera.expected_rms_px)
      continue;
    doubts.push_back(
        fmt::format("two halves of the images of {} disagree by {} px, more than the {} px from noise alone",
                    result.cameras[c].name, twoDigits(camera.rms_px), twoDigits(camera.expected_rms_px)));
  }
}

std::vector<std::string> doubtsOf(const Result& result) {
  std::vector<std::string> doubts;
  doubtCompleteness(*result.quality, doubts);
  doubtTimes(result, doubts);  // first, because wrong times make images and corners look bad, too
  doubtImages(result, doubts);
  doubtCorners(result, doubts);
  doubtLeverage(result, doubts);
  doubtHalves(result, doubts);
  doubtNoise(result, doubts);
  doubtIndependence(result, doubts);
  doubtProjection(result, doubts);
  doubtPatterns(result, doubts);
  doubtImu(result, doubts);
  return doubts;
}

}  // namespace slom::calibration
