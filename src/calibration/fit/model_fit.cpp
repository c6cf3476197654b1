#include "calibration/fit/model_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/fit/cross_validation.hpp"
#include "calibration/fit/lens_constraints.hpp"
#include "calibration/fit/rig.hpp"
#include "calibration/fit/single_camera.hpp"
#include "calibration/fit/unfitted_views.hpp"
#include "calibration/initialization/parallel_views.hpp"
#include "calibration/limits.hpp"
#include "calibration/side_by_side.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Throws if there are fewer measured numbers than unknowns.
void requireEnoughMeasurements(const Dataset& data, const Settings& settings) {
  std::size_t measured = 0;
  for (const CameraData& camera : data.cameras) measured += 2 * camera.cornerCount();
  const std::size_t cameras = data.cameras.size();
  std::size_t fixed = 0;
  for (const LensConstraint& constraint : settings.lens)
    fixed += constraint.isFixed() ? (constraint.camera.empty() ? cameras : 1) : 0;
  const std::size_t unknowns =
      cameras * settings.model.parameters().size() - fixed + 6 * (cameras - 1) + 6 * data.images().size();
  if (measured > unknowns) return;
  throw DataError("slom.calibration.too-few-data",
                  {.place = nameOf(data.cameras.front()),
                   .fault = fmt::format("the corners give {} numbers for {} unknowns of the model {}",
                                        measured, unknowns, settings.model.name()),
                   .remedy = "add images or corners, or choose a model with fewer parameters"});
}

/// Returns whether some camera's focal length has a standard deviation above a fifth of it, or the fit failed.
bool hasOpenFocalLength(const Result& result) {
  if (!result.success()) return true;
  return std::any_of(result.cameras.begin(), result.cameras.end(), [](const CameraResult& camera) {
    const Parameter& f = camera.parameters.front();
    return f.std > 0.2 * std::abs(f.value);
  });
}

/// Returns 1 if the boards lie level and the cameras see them from above when the world's z axis points up, -1 when
/// the z axis points down. Returns 0 if the boards do not lie level, or are seen from both sides.
int upOfLevelBoards(const Dataset& data, const Result& result) {
  constexpr double level = 0.87;  // cosine of 30 degrees
  std::map<int, SE3> left2world;
  for (const ImageResult& image : result.images) left2world.emplace(image.image, image.left2world);
  int up = 0;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (const View& view : data.cameras[c].views) {
      const SE3 plane2world = fitPlane(view.corners).plane2world;
      if (std::abs((plane2world.orient * vec3(0., 0., 1.)).z()) < level) return 0;
      const SE3 camera2world = left2world.at(view.image) * result.cameras[c].left2camera.inverse();
      const int side = camera2world.pos.z() > plane2world.pos.z() ? 1 : -1;
      if (up != 0 && side != up) return 0;
      up = side;
    }
  }
  return up;
}

/// Fits of single cameras, and start values of the rig from these fits.
struct ModelStart {
  std::vector<Lens> cameras;
  std::vector<double> rms_px_single;
  RigStart rig;
};

using PlanesByCamera = std::vector<std::vector<PlaneView>>;

PlanesByCamera planesOf(const Dataset& data) {
  PlanesByCamera planes(data.cameras.size());
  sideBySide(planes.size(), [&](std::size_t c) { planes[c] = planeViews(data.cameras[c]); });
  return planes;
}

ModelStart startModel(const Dataset& data, const PlanesByCamera& planes, const Settings& settings,
                      const Progress& progress) {
  requireEnoughMeasurements(data, settings);
  std::vector<std::optional<FitAlone>> fits(data.cameras.size());
  sideBySide(fits.size(), [&](std::size_t c) { fits[c] = fitAlone(data.cameras[c], planes[c], settings); });
  ModelStart start;
  std::vector<ViewPoses> world2camera;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const CameraData& camera = data.cameras[c];
    const FitAlone& fit = *fits[c];
    start.cameras.push_back(fit.camera);
    world2camera.push_back(fit.world2camera);
    start.rms_px_single.push_back(fit.converged ? fit.rms_px : unknown);
    if (progress.single_camera)
      progress.single_camera({&camera, fit.start, fit.converged, fit.iterations, fit.rms_px});
  }
  start.rig = startRig(data, world2camera);
  return start;
}

/// Optimizes from start values. Throws if the lens of the start values does not see a corner: then a wrong corner
/// spoiled the start values.
Summary optimizeFromStart(RigProblem& problem, const Options& options, const Dataset& data, Robust robust) {
  try {
    return problem.optimize(options);
  } catch (const slom::Error& error) {
    if (error.id() != "slom.not-finite" && error.id() != "slom.overflow") throw;
    throw DataError(
        "slom.calibration.no-start",
        {.place = nameOf(data.cameras.front()),
         .fault = "no start values were found at which the lens sees all corners",
         .remedy =
             robust == Robust::none
                 ? "look for corners that are far off, or leave them out by Settings::robust"
                 : "look for images whose corners are far off, or are numbered in another order than the "
                   "world points"});
  }
}

/// Computes a result from start values. If all boards are `parallel` (a sentence that says so), or if most views of a
/// camera contradict the others, a fit rarely succeeds and gets few iterations.
Result calibrateOnce(const Dataset& data, const PlanesByCamera& planes, const std::string& parallel,
                     Settings settings, const Progress& progress) {
  constexpr int few_iterations = 20;
  const auto [cameras, rms_px_single, rig] = startModel(data, planes, settings, progress);
  const std::vector<Stray> strays = findStrays(data, cameras, rig);
  if (!parallel.empty() || areMost(strays, data))
    settings.max_iterations = std::min(settings.max_iterations, few_iterations);

  std::optional<ImuStart> imu;
  std::vector<TiltPair> tilts;
  if (data.imu) {
    tilts = tiltPairs(*data.imu, rig.left2world);
    imu = startImu(tilts, settings.fixed, settings.sigma_acc);
    requireImuDetermined(*data.imu, tilts, *imu, settings.fixed, settings.sigma_acc);
  }

  RigProblem problem(data, settings, cameras, rig, imu);
  Options options = optionsOf(settings);
  options.observer = progress.iteration;
  Result result = problem.result(optimizeFromStart(problem, options, data, settings.robust));
  if (!parallel.empty() && hasOpenFocalLength(result)) result.declareUndetermined(parallel);
  for (std::size_t c = 0; c < cameras.size(); ++c) result.cameras[c].rms_px_single = rms_px_single[c];
  result.strays = strays;
  keepUnfitted(result);
  if (imu) {
    result.imu->tilt_spread = tiltSpread(tilts);
    result.imu->sign_evidence = imu->sign_evidence;
    result.imu->reads_gravity = settings.imu_reads_gravity;
    if (const int up = upOfLevelBoards(data, result))
      result.imu->up_is_known = true, result.imu->up_by_z = settings.imu_reads_gravity ? -up : up;
  }
  return result;
}

/// Standard deviation of a prior at 0 for k4, k5, k6 of opencv8. Numerator and denominator can have the same effect.
/// Without the prior, k4, k5, k6 may then diverge together with k1, k2, k3.
constexpr double sigma_of_denominator = 1;

/// Fits a model that may need its prior. Fits without the prior first, and with the prior only if that fit fails.
Result calibrateWithPriorIfNeeded(const Dataset& data, const PlanesByCamera& planes,
                                  const std::string& parallel, Settings settings, const Progress& progress) {
  std::vector<SingleCameraReport> alone;
  std::vector<IterationRecord> iterations;
  const Progress kept{[&](const SingleCameraReport& report) { alone.push_back(report); },
                      [&](const IterationRecord& record) { iterations.push_back(record); }};
  const Result result = calibrateOnce(data, planes, parallel, settings, kept);
  if (result.success() || !parallel.empty() || !reasonToEnd(settings.limits).empty()) {
    for (const SingleCameraReport& report : alone) {
      if (progress.single_camera) progress.single_camera(report);
    }
    for (const IterationRecord& record : iterations) {
      if (progress.iteration) progress.iteration(record);
    }
    return result;
  }
  settings.sigma_denominator = sigma_of_denominator;
  return calibrateOnce(data, planes, parallel, settings, progress);
}

/// Returns the settings with the prior from the start if the board is unknown, too. Numerator, denominator and board
/// can have the same effect. Steps in nearly undetermined directions are long and slow: minutes each in long
/// recordings.
Settings withPriorForBoard(Settings settings) {
  if (hasPrior(settings.model) && settings.board_shape != BoardShape::flat && !settings.sigma_denominator)
    settings.sigma_denominator = sigma_of_denominator;
  return settings;
}

ModelTrial tryModelOnce(const Dataset& data, const PlanesByCamera& planes, const Settings& settings) {
  ModelTrial trial{settings.model, settings.board_shape};
  try {
    const auto start = startModel(data, planes, settings, {});
    RigProblem problem(data, settings, start.cameras, start.rig, {});
    Options options = optionsOf(settings);
    options.most_parameters = 0;
    const Summary summary = problem.optimize(options);
    trial.unknowns = summary.unknowns;
    trial.redundancy = summary.redundancy;
    trial.rss = summary.final_rss;
    trial.rms_px = problem.rmsOfAll();
    if (!summary.converged) return trial.failure = summary.message, trial;
    const std::optional<FittedBoard> board = problem.board();
    trial.held_out_squares = heldOutSquares(data, settings, problem.cameras(), problem.rig(), board);
    if (!std::isfinite(trial.heldOutRms()))
      trial.failure = "some corners outside the fit have no image in this model";
  } catch (const DataError& error) {
    trial.failure = error.sentence();
    trial.error = error;
  } catch (const slom::Error& error) {
    trial.failure = sentenceOf(error);
  }
  return trial;
}

}  // namespace

Result calibrateModel(const Dataset& data, const Settings& given, const Progress& progress) {
  const Settings settings = withPriorForBoard(given);
  const PlanesByCamera planes = planesOf(data);
  const std::string parallel = parallelViews(planes, data.images().size());
  if (hasPrior(settings.model) && !settings.sigma_denominator)
    return calibrateWithPriorIfNeeded(data, planes, parallel, settings, progress);
  return calibrateOnce(data, planes, parallel, settings, progress);
}

Result calibrateModelFrom(const Result& start, const Dataset& data, const Settings& settings,
                          double tolerance) {
  requireEnoughMeasurements(data, settings);
  std::vector<Lens> cameras;
  RigStart rig;
  for (const CameraResult& camera : start.cameras) {
    cameras.push_back(lensOf(camera));
    rig.left2camera.push_back(camera.left2camera);
  }
  const std::vector<int> wanted = data.images();
  for (const ImageResult& image : start.images) {
    if (std::binary_search(wanted.begin(), wanted.end(), image.image))
      rig.left2world[image.image] = image.left2world;
  }
  Settings same = settings;
  same.sigma_denominator = start.sigma_denominator;
  RigProblem problem(data, same, cameras, rig, {}, start.board ? &*start.board : nullptr);
  Options options = optionsOf(settings);
  options.most_parameters = 0;
  options.deviation_tolerance = tolerance;
  options.decrease_tolerance =
      rough_tolerance;  // the start is so near that the rest is far below a standard deviation
  const Summary summary = problem.optimize(options);
  return problem.result(summary, tolerance < rough_deviations ? nullptr : &start);
}

ModelTrial tryModel(const Dataset& data, const Settings& given) {
  const PlanesByCamera planes = planesOf(data);
  Settings settings = withPriorForBoard(given);
  ModelTrial trial = tryModelOnce(data, planes, settings);
  if (!hasPrior(settings.model) || settings.sigma_denominator || trial.failure.empty() ||
      !reasonToEnd(settings.limits).empty())
    return trial;
  settings.sigma_denominator = sigma_of_denominator;
  return tryModelOnce(data, planes, settings);
}

}  // namespace slom::calibration
