#include "calibration/fit/single_camera.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <slom/slom.hpp>

#include "calibration/fit/lens_constraints.hpp"
#include "calibration/fit/measurements.hpp"
#include "calibration/fit/pose_of_view.hpp"
#include "calibration/initialization/fisheye.hpp"
#include "calibration/initialization/intrinsics.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/models/definition.hpp"

namespace slom::calibration {

double squaredPixelError(const Lens& camera, const SE3& world2camera, const View& view) {
  double sum = 0;
  for (const Corner& corner : view.corners) {
    const vec3 point = world2camera * corner.world;
    sum += (camera.project(point) - corner.pixel).squaredNorm();
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

double medianPixelError(const Lens& camera, const SE3& world2camera, const View& view) {
  std::vector<double> errors;
  for (const Corner& corner : view.corners) {
    const double error = (camera.project(vec3(world2camera * corner.world)) - corner.pixel).norm();
    errors.push_back(std::isfinite(error) ? error : std::numeric_limits<double>::infinity());
  }
  return medianOf(errors);
}

namespace {

/// Returns the better of two poses. A small board seen from afar looks nearly the same when tilted the other way.
/// Fits both poses unless the other one is clearly worse.
SE3 poseResolvingAmbiguity(const Lens& camera, const PlaneView& plane, const SE3& world2camera,
                           const View& view) {
  constexpr double clearly_worse = 16;  // squared error
  const double error = squaredPixelError(camera, world2camera, view);
  if (squaredPixelError(camera, tiltedOtherWay(plane, world2camera), view) > clearly_worse * error)
    return world2camera;
  const FittedPose one = fittedPose(camera, view, world2camera, Look::quick);
  const FittedPose other = fittedPose(camera, view, tiltedOtherWay(plane, one.world2camera), Look::quick);
  return other.square < one.square ? other.world2camera : one.world2camera;
}

/// Fits intrinsics and poses together, starting from the values in `fit`. Keeps these values if the result is not
/// better.
void fitIntrinsics(const CameraData& data, FitAlone& fit, const Settings& settings) {
  Estimator est;
  est.changeAlgorithm(LevenbergMarquardt(1e-6));
  const auto camera = est.insertRV(fit.camera, true, data.name);
  constrain(est, camera, data.name, settings);
  if (settings.sigma_denominator) addPrior(est, camera, *settings.sigma_denominator / settings.sigma_px);
  std::map<int, VarID<SE3>> poses;
  for (const View& view : data.views) {
    const auto pose = est.insertRV(fit.world2camera.at(view.image).inverse(), true,
                                   data.name + "2world[" + std::to_string(view.image) + "]");
    poses.emplace(view.image, pose);
    est.insertMeasurement(ViewOfLeft(view), camera, pose);
  }
  Options options;
  options.max_iterations = settings.max_iterations;
  options.most_parameters = 0;  // skips statistics, which are not used
  options.decrease_tolerance = rough_tolerance;
  options.deviation_tolerance = std::numeric_limits<double>::infinity();
  applyLimits(settings.limits, options);
  const Summary summary = est.optimize(options);
  fit.iterations += summary.iterations;
  ViewPoses world2camera;
  double error = 0;
  for (const View& view : data.views) {
    world2camera[view.image] = poses.at(view.image)->inverse();
    error += squaredPixelError(*camera, world2camera[view.image], view);
  }
  if (!std::isfinite(error)) return;  // boards ended up behind the camera
  fit.converged = summary.converged;
  fit.camera = *camera;
  fit.world2camera = world2camera;
  fit.rms_px = std::sqrt(error / double(data.cornerCount()));
}

/// Fits from one camera, with the views as planes seen by `pinhole`. A failed fit returns the start values, with
/// better poses.
FitAlone fitAloneFrom(const Lens& camera, const Pinhole& pinhole, const CameraData& data,
                      const std::vector<PlaneView>& planes, const Settings& settings) {
  FitAlone fit{constrained(camera, data.name, settings)};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const SE3 rough = poseFromHomography(planes[i], pinhole);
    fit.world2camera[data.views[i].image] =
        poseResolvingAmbiguity(fit.camera, planes[i], rough, data.views[i]);
  }
  const bool is_determined =
      2 * data.cornerCount() >= std::size_t(camera.parameters()) + 6 * data.views.size();
  try {
    if (is_determined) fitIntrinsics(data, fit, settings);
  } catch (const slom::Error&) {  // one camera does not determine it; the others may help
  }
  if (std::isfinite(fit.rms_px)) return fit;
  for (const View& view : data.views) {
    SE3& pose = fit.world2camera.at(view.image);
    pose = fittedPose(fit.camera, view, pose, Look::quick).world2camera;
  }
  return fit;
}

}  // namespace

FitAlone fitAlone(const CameraData& data, std::vector<PlaneView> planes, const Settings& settings) {
  const ModelDefinition& model = settings.model.definition();
  const bool is_equidistant = model.start_lens == StartLens::equidistant;
  const IntrinsicsStart start = is_equidistant ? startFisheye(planes) : startIntrinsics(planes);
  if (is_equidistant) planes = flattened(planes, start.pinhole);
  std::optional<FitAlone> best;
  for (const auto& parameters : model.starts(start.pinhole)) {
    FitAlone fit = fitAloneFrom(Lens(settings.model, parameters), start.pinhole, data, planes, settings);
    const bool is_better = !best || fit.converged > best->converged ||
                           (fit.converged == best->converged && fit.rms_px < best->rms_px);
    if (is_better) best = std::move(fit);
  }
  best->start = start.source;
  return *best;
}

}  // namespace slom::calibration
