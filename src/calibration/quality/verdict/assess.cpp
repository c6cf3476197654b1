#include "slom/calibration/assess.hpp"

#include <chrono>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calibration/data/check.hpp"
#include "calibration/data/fitted_board.hpp"
#include "calibration/data/image_box.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/result_of.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/well_formed.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/limits.hpp"
#include "calibration/quality/patterns/patterns.hpp"
#include "calibration/quality/patterns/residuals.hpp"
#include "calibration/quality/patterns/split_half.hpp"
#include "calibration/quality/uncertainty/clustered.hpp"
#include "calibration/quality/uncertainty/correlations.hpp"
#include "calibration/quality/uncertainty/determination.hpp"
#include "calibration/quality/uncertainty/projection.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "calibration/quality/verdict/doubts.hpp"
#include "calibration/quality/verdict/next_best_view.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr int grid_columns = 33;
constexpr std::size_t worst_corners = 20;

/// Returns a grid whose nodes are as far apart along u as along v, as nearly as possible. The number of nodes is odd,
/// so that there is a middle one.
ImageGrid gridOver(const ImageBox& box) {
  const double ratio = (box.height - 1.0) / std::max(box.width - 1.0, 1.0);
  const int rows = 2 * int(std::lround((grid_columns - 1) * std::min(ratio, 3.0) / 2)) + 1;
  return {grid_columns, std::max(rows, 5), box};
}

class PhaseClock {
 public:
  explicit PhaseClock(std::vector<PhaseTime>& times) : times_(times) {}
  void record(const char* phase) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({phase, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<PhaseTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void addProjection(const FittedRig& rig, const Posterior& posterior, const Posterior& stated,
                   double board_distance_m, const Settings& settings, std::vector<CameraQuality>& cameras) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    requireTime(settings.limits);
    CameraQuality& camera = cameras[c];
    const CameraPosterior known(rig, posterior, c);
    const double infinity = std::numeric_limits<double>::infinity();
    const auto rays = raysOf(rig.lenses[c], camera.grid);
    camera.projection = known.maps(camera.grid, rays, {board_distance_m, infinity});
    camera.projection_stated =
        CameraPosterior(rig, stated, c).maps(camera.grid, rays, {board_distance_m, infinity});
    ImageGrid coarse = camera.grid;
    coarse.columns = 9, coarse.rows = 7;
    constexpr int distances = 25;  // from a third of the boards' distance to far behind them
    for (int i = 0; i < distances; ++i)
      camera.distances_m.push_back(board_distance_m * std::pow(10, -0.5 + 2.0 * i / (distances - 1)));
    for (const ProjectionUncertainty& map :
         known.maps(coarse, raysOf(rig.lenses[c], coarse), camera.distances_m)) {
      camera.middle_px.push_back(map.middle_px);
      camera.worst_px.push_back(map.worst_px);
    }
  }
}

void addDetermination(const Dataset& on_board, const Result& result, const FittedRig& rig,
                      const Eigen::MatrixXd& covariance, std::vector<CameraQuality>& cameras) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const int n = rig.lenses[c].parameters(), first = rig.columns.lens[c];
    const AxisUncertainty axis = axisUncertainty(rig.lenses[c], covariance.block(first, first, n, n));
    cameras[c].focal_std = axis.focal;
    cameras[c].centre_std_px = axis.centre_px;
    cameras[c].tilt_spread = tiltSpreadOf(on_board, result, c);
  }
}

/// Returns the largest worst_px of all cameras, of the maps `at`: 0, at the distance of the boards, or 1, at
/// infinity.
double worstOf(const Quality& quality, std::vector<ProjectionUncertainty> CameraQuality::*maps,
               std::size_t at) {
  double most = 0;
  for (const CameraQuality& camera : quality.cameras) most = std::fmax(most, (camera.*maps)[at].worst_px);
  return most;
}

/// Returns the map that further images should improve: the map at infinity if only that exceeds the bearable
/// uncertainty.
std::size_t mapToImprove(const Quality& quality) {
  const auto maps = &CameraQuality::projection;
  return worstOf(quality, maps, 0) <= worst_bearable_px && worstOf(quality, maps, 1) > worst_bearable_px ? 1
                                                                                                         : 0;
}

/// Scales the effect of further images to the clustered uncertainty. Images as good as the existing ones reduce it by
/// the same factor as the stated one.
void scaleToClustered(std::size_t map, Quality& quality) {
  const double factor = worstOf(quality, &CameraQuality::projection, map) /
                        worstOf(quality, &CameraQuality::projection_stated, map);
  if (!std::isfinite(factor)) return;
  for (FurtherView& view : quality.further_views) view.before_px *= factor, view.after_px *= factor;
}

/// Adds the expected accuracy of a calibration that succeeded. `on_board`: the data on the fitted board. Throws
/// WorkEnded if the time does not suffice.
void addExpectations(const Dataset& data, const Dataset& on_board, const Settings& settings,
                     const Result& result, const FittedRig& rig, const std::vector<ImageGrid>& grids,
                     PhaseClock& clock, Quality& quality) {
  const std::map<int, Observation> observations = observationsOf(on_board, rig);
  Information information(rig.columns);
  for (const auto& [image, observation] : observations) {
    requireTime(settings.limits);
    information.add(informationOf(rig, observation));
  }
  information.addPrior(rig);
  const Posterior stated = statedPosterior(on_board, rig, information);
  quality.is_clustered = result.clustered && result.clustered->isReliable();
  const Posterior posterior =
      quality.is_clustered ? Posterior(information, covarianceOf(*result.clustered)) : stated;
  quality.board_distance_m = boardDistance(observations, rig);
  quality.correlations = correlationsOf(rig.columns, stated.covarianceOfShared());
  clock.record("covariance");
  quality.patterns = residualPatterns(on_board, rig, stated.covarianceOfShared(), grids, settings.limits);
  clock.record("patterns");
  addProjection(rig, posterior, stated, quality.board_distance_m, settings, quality.cameras);
  addDetermination(on_board, result, rig, posterior.covarianceOfShared(), quality.cameras);
  clock.record("projection");
  quality.split_half = splitHalf(data, settings, result, grids);
  clock.record("split_half");
  FurtherViewOptions options;
  options.board_distance_m = quality.board_distance_m;
  options.limits = settings.limits;
  const std::size_t map = mapToImprove(quality);
  options.of_distance_m = quality.cameras.front().projection[map].distance_m;
  quality.further_views = furtherViews(rig, information, fullestView(on_board), grids, options);
  if (quality.is_clustered) scaleToClustered(map, quality);
  clock.record("further_views");
}

void cutShort(const std::string& reason, Quality& quality) {
  quality.cut_short = reason;
  if (quality.split_half.cameras.empty() && quality.split_half.why_not.empty())
    quality.split_half.why_not = reason;
}

void requireResultOf(const Dataset& data, const Settings& settings, const Result& result) {
  std::string difference = differenceOf(data, result);
  const std::string model = result.cameras.empty() ? "" : result.cameras.front().model;
  if (difference.empty() && model != settings.model.name())
    difference =
        fmt::format("the result has the model {}, the settings have {}", model, settings.model.name());
  if (difference.empty() && result.sigma_px != settings.sigma_px)
    difference = fmt::format("sigma_px is {} in the result, and {} in the settings", result.sigma_px,
                             settings.sigma_px);
  if (difference.empty()) return;
  throw DataError(
      "slom.calibration.no-result",
      fmt::format("there is nothing to assess: {}; pass the result of calibrate() with these data "
                  "and settings",
                  difference),
      "result");
}

Quality assessSorted(const Dataset& data, const Settings& settings, const Result& result) {
  Quality quality;
  PhaseClock clock(quality.times);
  const FittedRig rig(result);
  const DataOnBoard on_board(data, result.board);
  std::vector<ImageGrid> grids;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    grids.push_back(gridOver(imageBoxOf(data.cameras[c], result.cameras[c])));
    CameraQuality camera;
    camera.grid = grids.back();
    camera.residuals = residualsOf((*on_board).cameras[c], rig, c);
    quality.cameras.push_back(std::move(camera));
  }
  quality.worst = worstResiduals(data, quality.cameras, worst_corners);
  clock.record("residuals");
  if (!result.success()) return quality;
  try {
    addExpectations(data, *on_board, started(settings), result, rig, grids, clock, quality);
  } catch (const WorkEnded& ended) {
    cutShort(ended.what(), quality);
  }
  return quality;
}

}  // namespace

Quality assess(const Dataset& all, const Settings& settings, const Result& result) {
  checkSettings(all, settings);
  requireWellFormed(all);
  checkImuImages(all);
  const Dataset data = withoutRejected(all, result);
  requireResultOf(data, settings, result);
  const SortedDataset sorted(data);
  return assessSorted(asFitted(result, *sorted), settings, result);
}

}  // namespace slom::calibration
