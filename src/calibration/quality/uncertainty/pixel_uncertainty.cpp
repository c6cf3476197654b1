#include "slom/calibration/pixel_uncertainty.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibration/data/check.hpp"
#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/result_of.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/well_formed.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/quality/uncertainty/clustered.hpp"
#include "calibration/quality/uncertainty/projection.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

[[noreturn]] void refuseResult(const std::string& why) {
  throw DataError(
      "slom.calibration.no-result",
      fmt::format("there is no uncertainty of pixels: {}; pass the result of calibrate() with these data",
                  why),
      "result");
}

void requirePixelsOf(const Dataset& data, const Result& result) {
  if (!result.success()) {
    refuseResult(result.undetermined.empty() ? "the calibration did not converge" : result.undetermined);
  }
  if (data.cameras.empty()) refuseResult("the data have no camera");
  const std::string difference = differenceOf(data, result);
  if (!difference.empty()) refuseResult(difference);
}

Posterior posteriorOf(const Dataset& data, const Result& result, const FittedRig& rig) {
  Information information(rig.columns);
  for (const auto& [image, seen] : observationsOf(data, rig)) information.add(informationOf(rig, seen));
  information.addPrior(rig);
  const bool is_clustered = result.clustered && result.clustered->isReliable();
  return is_clustered ? Posterior(information, covarianceOf(*result.clustered))
                      : statedPosterior(data, rig, information);
}

[[noreturn]] void refuseQuestion(const char* subject, const std::string& sentence) {
  throw DataError("slom.calibration.bad-question", sentence, subject);
}

}  // namespace

double PixelCovariance::largestStd() const { return calibration::largestStd(uu, uv, vv); }

struct PixelUncertainty::Implementation {
  explicit Implementation(const Dataset& data, const Result& result) : rig(result) {
    const Posterior posterior = posteriorOf(data, result, rig);
    for (std::size_t c = 0; c < rig.lenses.size(); ++c) cameras.emplace_back(rig, posterior, c);
  }

  FittedRig rig;
  std::vector<CameraPosterior> cameras;  // these point into the rig
};

PixelUncertainty::PixelUncertainty(const Dataset& all, const Result& result) {
  requireWellFormed(all);
  checkImuImages(all);
  const Dataset data = withoutRejected(all, result);
  requirePixelsOf(data, result);
  const SortedDataset sorted(data);
  const Dataset weighted = asFitted(result, *sorted);
  impl_ = std::make_shared<const Implementation>(*DataOnBoard(weighted, result.board), result);
}

std::optional<PixelCovariance> PixelUncertainty::at(std::size_t camera, const vec2& pixel,
                                                    double distance_m) const {
  const std::size_t count = impl_->cameras.size();
  if (camera >= count) {
    refuseQuestion("camera",
                   fmt::format("there is no camera {}; pass a number from 0 to {}", camera, count - 1));
  }
  if (!pixel.allFinite()) {
    refuseQuestion("pixel", fmt::format("the pixel is ({}, {}); pass finite numbers", pixel.x(), pixel.y()));
  }
  if (!(distance_m > 0)) {
    refuseQuestion("distance_m",
                   fmt::format("the distance is {} m; pass a positive number, or infinity", distance_m));
  }
  const std::optional<vec3> ray = impl_->rig.lenses[camera].unproject(pixel);
  if (!ray) return std::nullopt;
  return impl_->cameras[camera].covarianceAt(*ray, distance_m);
}

}  // namespace slom::calibration
