#include "slom/calibration/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibration/data/check.hpp"
#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/well_formed.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/fit/model_fit.hpp"
#include "calibration/initialization/far_off.hpp"
#include "calibration/initialization/view_misfit.hpp"
#include "calibration/limits.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/procedure/corner_noise.hpp"
#include "calibration/procedure/fit_once.hpp"
#include "calibration/procedure/mirrored_views.hpp"
#include "calibration/procedure/stray_views.hpp"
#include "calibration/quality/uncertainty/clustered.hpp"

namespace slom::calibration {

namespace {

/// Computes the residuals of the rejected corners, which the fit does not use.
void predictRejected(const Dataset& of_flat_board, Result& result) {
  const DataOnBoard on_board(of_flat_board, result.board);
  const Dataset& data = *on_board;
  for (GrossCorner& corner : result.rejected) {
    const CameraResult& camera = result.cameras[corner.camera];
    const View* const view = data.cameras[corner.camera].find(corner.image);
    const auto image = std::find_if(result.images.begin(), result.images.end(),
                                    [&](const ImageResult& one) { return one.image == corner.image; });
    const auto found = std::find_if(view->corners.begin(), view->corners.end(),
                                    [&](const Corner& one) { return one.number == corner.number; });
    if (image == result.images.end()) continue;  // the fit failed early
    const vec3 in_left = image->left2world.inverse() * found->world;
    corner.error_px = corner.error_without_px =
        (camera.project(camera.left2camera * in_left) - found->pixel).norm();
  }
  std::stable_sort(
      result.rejected.begin(), result.rejected.end(),
      [](const GrossCorner& a, const GrossCorner& b) { return a.error_without_px > b.error_without_px; });
}

/// Fits the same images again, starting from the first result. Copies values that only a fit from the beginning
/// computes.
Result fittedAgain(const Dataset& data, const Settings& settings, const Result& first,
                   double tolerance = enough_deviations) {
  Result next =
      data.imu ? calibrateModel(data, settings, {}) : calibrateModelFrom(first, data, settings, tolerance);
  next.rejected = first.rejected;
  next.strays = first.strays;
  next.sigma_denominator = first.sigma_denominator;
  for (std::size_t c = 0; c < next.cameras.size(); ++c) {
    next.cameras[c].rms_px_single = first.cameras[c].rms_px_single;
    next.cameras[c].noise = first.cameras[c].noise;
  }
  next.downweighted = first.downweighted;
  return next;
}

/// Fits again without the worst gross corners until none is left. Skips fits whose images contradict each other.
Result withoutGrossCorners(const Dataset& data, const Settings& settings, Result result) {
  constexpr int most_rounds = 10;
  bool is_rough = false;
  std::optional<Clustering> clustering(std::in_place, withoutRejected(data, result), result);
  clustering->addGrossCorners(result);
  for (int round = 0; round < most_rounds && result.success() && result.strays.empty(); ++round) {
    const std::vector<GrossCorner> worst = rejectable(data, result);
    if (worst.empty() || !reasonToEnd(settings.limits).empty()) break;
    Result without = result;
    without.rejected.insert(without.rejected.end(), worst.begin(), worst.end());
    const Dataset rest = withoutRejected(data, without);
    Result next = fittedAgain(rest, settings, without, rough_deviations);
    if (!next.success()) break;  // values fitted to all corners are better than none
    result = std::move(next);
    is_rough = true;
    clustering.emplace(rest, result);
    clustering->addGrossCorners(result);
  }
  if (is_rough) {
    const Dataset rest = withoutRejected(data, result);
    if (Result next = fittedAgain(rest, settings, result); next.success()) {
      result = std::move(next);
      clustering.emplace(rest, result);
      clustering->addGrossCorners(result);
    }
  }
  clustering->addClustered(result);
  return result;
}

/// Returns the largest change of a lens parameter, in its standard deviations.
double changeBetween(const Result& a, const Result& b) {
  double most = 0;
  for (std::size_t c = 0; c < a.cameras.size(); ++c) {
    for (std::size_t i = 0; i < a.cameras[c].parameters.size(); ++i) {
      const Parameter &p = a.cameras[c].parameters[i], &q = b.cameras[c].parameters[i];
      if (p.std > 0) most = std::max(most, std::abs(p.value - q.value) / p.std);
    }
  }
  return most;
}

/// Returns whether noise, or motion while rows are read, is estimated alternately with the fit.
bool isRefined(const Settings& settings) { return estimatesNoise(settings) || settings.rolling_shutter; }

/// Returns the largest change of a readout, in its standard deviation.
double changeOfReadout(const Result& before, const Result& after) {
  double most = 0;
  for (std::size_t c = 0; c < after.cameras.size(); ++c) {
    const auto &from = before.cameras[c].readout, &to = after.cameras[c].readout;
    if (to) most = std::max(most, std::abs(to->value - (from ? from->value : 0)) / to->std);
  }
  return most;
}

/// Returns `data` with Corner::sigma from the same corners of `others`.
Dataset withSigmasOf(const Dataset& others, Dataset data) {
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (std::size_t v = 0; v < data.cameras[c].views.size(); ++v) {
      auto& corners = data.cameras[c].views[v].corners;
      for (std::size_t k = 0; k < corners.size(); ++k)
        corners[k].sigma = others.cameras[c].views[v].corners[k].sigma;
    }
  }
  return data;
}

/// Alternates between fitting and estimating noise from the residuals and motion from the poses, until the parameters
/// stay the same. If a fit fails, keeps the result of the round before, with the noise of its fit. Does not fit again
/// after a result that did not succeed.
Result refined(const Dataset& data, const Settings& settings, Result result) {
  constexpr int most_rounds = 50;
  constexpr double least_change = 1e-3;  // standard deviations
  for (int round = 0; round < most_rounds && result.success(); ++round) {
    if (!reasonToEnd(settings.limits).empty()) break;
    Result proposed = result;
    if (estimatesNoise(settings)) estimateNoise(withoutReadout(data, proposed), settings, proposed);
    const Dataset seen = asFitted(proposed, data);
    Dataset moving = settings.rolling_shutter ? withMotion(proposed, data) : data;
    Result next = fittedAgain(withSigmasOf(seen, std::move(moving)), settings, proposed);
    if (!next.success()) break;
    const double change = std::max(changeBetween(result, next), changeOfReadout(result, next));
    result = std::move(next);
    if (change < least_change) break;
  }
  addClustered(asFitted(result, data), result);
  return result;
}

/// Takes back corners that were left out before the fit, if the fitted lens predicts them within the noise. The
/// homography that left them out cannot describe lenses of 180 degrees.
Result withTakenBack(const Dataset& data, const Settings& settings, Result result) {
  constexpr double by_noise = 4.5;  // distance over RMS
  constexpr int most_rounds = 3;
  for (int round = 0; round < most_rounds && result.success() && !result.rejected.empty(); ++round) {
    predictRejected(data, result);
    Result with = result;
    std::erase_if(with.rejected, [&](const GrossCorner& corner) {
      return corner.error_without_px <= by_noise * result.cameras[corner.camera].rms_px;
    });
    if (with.rejected.size() == result.rejected.size()) break;
    Result next = fittedAgain(withoutRejected(data, with), settings, with);
    if (!next.success()) break;
    result = std::move(next);
  }
  return result;
}

/// Returns the progress of a fit of `rest` that reports the cameras of `data`.
Progress ofCameras(const Dataset& data, const Dataset& rest, const Progress& progress) {
  Progress of_data = progress;
  if (progress.single_camera) {
    of_data.single_camera = [&](SingleCameraReport report) {
      report.camera = &data.cameras[std::size_t(report.camera - rest.cameras.data())];
      progress.single_camera(report);
    };
  }
  return of_data;
}

/// Fits without the corners that are farthest off, then without the other gross corners.
Result withoutFarOffCorners(const Dataset& data, const Settings& settings, const Progress& progress) {
  Result without;
  without.rejected = farOffCorners(data);
  const Dataset rest = withoutRejected(data, without);
  Result result = calibrateModel(rest, settings, ofCameras(data, rest, progress));
  result.rejected = std::move(without.rejected);
  result = withTakenBack(data, settings, std::move(result));
  if (settings.robust == Robust::reject) result = withoutGrossCorners(data, settings, std::move(result));
  if (isRefined(settings)) {
    const Dataset accepted = withoutRejected(data, result);
    result = refined(accepted, settings, std::move(result));
  }
  predictRejected(data, result);
  return result;
}

/// Fits all data, without single corners that contradict the others.
Result fitOfAll(const Dataset& data, const Settings& settings, const Progress& progress) {
  if (settings.robust != Robust::none) return withoutFarOffCorners(data, settings, progress);
  Result result = calibrateModel(data, settings, progress);
  if (isRefined(settings)) return refined(data, settings, std::move(result));
  addClustered(data, result);
  return result;
}

bool isNoStart(const DataError& error) {
  return error.id() == "slom.calibration.no-start" || error.id() == "slom.calibration.no-pose";
}

/// Fits all data. Takes a second look if the fit fails, or if corners are farther off than detection explains.
Result fitWithSecondLook(const Dataset& data, const Settings& settings, const Progress& progress) {
  const auto quietly = [&](const Dataset& some) { return fitOfAll(some, settings, {}); };
  const auto withSecondLook = [&](const Dataset& some) { return fitWithSecondLook(some, settings, {}); };
  std::optional<Result> first;
  try {
    first = fitOfAll(data, settings, progress);
  } catch (const DataError& error) {
    if (!isNoStart(error)) throw;
    if (auto without = withoutUnfitViewsOfRig(data, settings, nullptr, quietly, withSecondLook))
      return std::move(*without);
    if (settings.robust == Robust::none) throw;
    if (auto without = withoutStrayViews(data, settings, nullptr, quietly)) return std::move(*without);
    throw;
  }
  if (!reasonToEnd(settings.limits).empty()) return std::move(*first);
  if (first->strays.empty() && !isBadFit(*first, settings)) {
    if (auto without = withoutScaledViews(data, settings, *first, quietly)) return std::move(*without);
    return std::move(*first);
  }
  if (auto without = withoutUnfitViewsOfRig(data, settings, &*first, quietly, withSecondLook))
    return std::move(*without);
  if (settings.robust != Robust::none) {
    if (auto without = withoutStrayViews(data, settings, &*first, quietly)) return std::move(*without);
    if (auto without = withoutViewsToScale(data, settings, *first, quietly)) return std::move(*without);
    if (isLong(data) &&
        first->strays.empty()) {  // a few blurred images make the fit a bad one, but not its lens
      if (auto without = withoutScaledViews(data, settings, *first, quietly)) return std::move(*without);
    }
  }
  if (first->strays.empty())
    nameCauses(data, settings, *first);
  else
    nameOtherEnd(data, quietly, *first);
  return std::move(*first);
}

/// Fits without views that show the board mirrored. Such views may fit well, or pull the fit towards them.
Result fitWithoutMirroredViews(const Dataset& data, const Settings& settings, const Progress& progress) {
  std::vector<Stray> mirrored;
  if (settings.robust != Robust::none) mirrored = mirroredViews(data);
  if (mirrored.empty()) return fitWithSecondLook(data, settings, progress);
  const Dataset rest = withoutViews(data, mirrored);
  Result result = fitWithSecondLook(rest, settings, ofCameras(data, rest, progress));
  addMirroredViews(std::move(mirrored), data, result);
  return result;
}

}  // namespace

Result fitOnce(const Dataset& data, const Settings& settings) {
  checkSettings(data, settings);
  requireWellFormed(data);
  const SortedDataset sorted(data);
  checkDataset(*sorted);
  return fitOfAll(*sorted, started(settings), {});
}

Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress) {
  checkSettings(data, settings);
  requireWellFormed(data);
  const SortedDataset sorted(data);
  checkDataset(*sorted);
  Progress of_caller = progress;
  if (progress.single_camera) {
    of_caller.single_camera = [&](SingleCameraReport report) {
      report.camera = &sorted.ofCaller(*report.camera);
      progress.single_camera(report);
    };
  }
  for (const CameraData& camera : (*sorted).cameras) requireSmoothViews(camera);
  return fitWithoutMirroredViews(*sorted, started(settings), of_caller);
}

}  // namespace slom::calibration
