// One camera without the others: intrinsics and the pose of each of its views.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/fit/lens_constraints.hpp"
#include "calibration/fit/measurements.hpp"
#include "calibration/initialization/fisheye.hpp"
#include "calibration/initialization/intrinsics.hpp"
#include "calibration/initialization/rig.hpp"
#include "calibration/initialization/view_pose.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Tolerance of fits whose results are start values of others: five digits of the RMS.
inline constexpr double rough_tolerance = 1e-6;
/// How near to the solution fits end, in standard deviations: what is printed has no more digits.
inline constexpr double enough_deviations = 1e-4;

template <class Camera>
struct FitAlone {
  Camera camera;
  ViewPoses world2camera;
  bool converged = false;  ///< otherwise camera and poses are start values
  int iterations = 0;
  double rms_px = unknown;
  std::string start;  ///< how the intrinsics were found, in a few words
};

/// Sum of squared distances between corners and pixels [px^2]; infinite when a corner has no image, as behind the camera.
template <class Camera>
double squaredPixelError(const Camera& camera, const SE3& world2camera, const View& view) {
  double sum = 0;
  for (const Corner& corner : view.corners) {
    const vec3 point = world2camera * corner.world;
    sum += (camera.project(point) - corner.pixel).squaredNorm();
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

/// The median of the distances between corners and pixels [px]; infinite where that corner has no image.
template <class Camera>
double medianPixelError(const Camera& camera, const SE3& world2camera, const View& view) {
  std::vector<double> errors;
  for (const Corner& corner : view.corners) {
    const double error = (camera.project(vec3(world2camera * corner.world)) - corner.pixel).norm();
    errors.push_back(std::isfinite(error) ? error : std::numeric_limits<double>::infinity());
  }
  return medianOf(errors);
}

/// The pose of one view for a known camera, from a start; the start itself when the fit fails.
template <class Camera>
SE3 fitPose(const Camera& known_camera, const SE3& world2camera, const View& view, const Settings& settings) {
  Estimator est;
  est.changeAlgorithm(LevenbergMarquardt());
  const auto pose = est.insertRV(world2camera.inverse(), true, "camera2world");
  est.insertMeasurement(ViewOfLeft(view), known_camera, pose);
  try {
    Options options;
    options.most_parameters = 0;
    options.decrease_tolerance = rough_tolerance;
    options.deviation_tolerance = std::numeric_limits<double>::infinity();
    applyLimits(settings.limits, options);
    est.optimize(options);
  } catch (const slom::Error&) {  // a corner on the camera's plane: the start is better
    return world2camera;
  }
  const SE3 fitted = pose->inverse();
  return squaredPixelError(known_camera, fitted, view) < squaredPixelError(known_camera, world2camera, view)
             ? fitted
             : world2camera;
}

/// A small board seen from afar looks nearly the same when it is tilted the other way: where that is not clearly worse, fits
/// both and keeps the better.
template <class Camera>
SE3 poseResolvingAmbiguity(const Camera& camera, const PlaneView& plane, const SE3& world2camera,
                           const View& view, const Settings& settings) {
  constexpr double clearly_worse = 16;  // squared error
  const double error = squaredPixelError(camera, world2camera, view);
  if (squaredPixelError(camera, tiltedOtherWay(plane, world2camera), view) > clearly_worse * error)
    return world2camera;
  const SE3 one = fitPose(camera, world2camera, view, settings);
  const SE3 other = fitPose(camera, tiltedOtherWay(plane, one), view, settings);
  return squaredPixelError(camera, other, view) < squaredPixelError(camera, one, view) ? other : one;
}

/// Intrinsics and poses together, from the values in `fit`, which keeps them when the result is not better.
template <class Camera>
void fitIntrinsics(const CameraData& data, FitAlone<Camera>& fit, const Settings& settings) {
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
  options.most_parameters = 0;  // its statistics are not looked at
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
  if (!std::isfinite(error)) return;  // ended with boards behind the camera
  fit.converged = summary.converged;
  fit.camera = *camera;
  fit.world2camera = world2camera;
  fit.rms_px = std::sqrt(error / double(data.cornerCount()));
}

/// From one camera and the views as planes that `pinhole` sees. A fit that fails leaves the start values, with better poses.
template <class Camera>
FitAlone<Camera> fitAloneFrom(const Camera& camera, const Pinhole& pinhole, const CameraData& data,
                              const std::vector<PlaneView>& planes, const Settings& settings) {
  FitAlone<Camera> fit;
  fit.camera = constrained(camera, data.name, settings);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const SE3 rough = poseFromHomography(planes[i], pinhole);
    fit.world2camera[data.views[i].image] =
        poseResolvingAmbiguity(fit.camera, planes[i], rough, data.views[i], settings);
  }
  const bool is_determined = 2 * data.cornerCount() >= std::size_t(Camera::DOF) + 6 * data.views.size();
  try {
    if (is_determined) fitIntrinsics(data, fit, settings);
  } catch (const slom::Error&) {  // not determined by a single camera; the others may help
  }
  if (std::isfinite(fit.rms_px)) return fit;
  for (const View& view : data.views) {
    SE3& pose = fit.world2camera.at(view.image);
    pose = fitPose(fit.camera, pose, view, settings);
  }
  return fit;
}

/// Start values of the intrinsics: for a model with several minima, one in the basin of attraction of each.
template <class Camera>
std::vector<Camera> startsFrom(const Pinhole& pinhole) {
  if constexpr (requires { Camera::startsFromPinhole(pinhole); }) {
    const auto starts = Camera::startsFromPinhole(pinhole);
    return {starts.begin(), starts.end()};
  } else {
    return {Camera::fromPinhole(pinhole)};
  }
}

/// From the views as planes: start values, then all together; of several starts the one whose fit is best.
template <class Camera>
FitAlone<Camera> fitAlone(const CameraData& data, std::vector<PlaneView> planes, const Settings& settings) {
  constexpr bool is_equidistant = Camera::start_lens == StartLens::equidistant;
  const IntrinsicsStart start = is_equidistant ? startFisheye(planes) : startIntrinsics(planes);
  if (is_equidistant) planes = flattened(planes, start.pinhole);
  std::optional<FitAlone<Camera>> best;
  for (const Camera& camera : startsFrom<Camera>(start.pinhole)) {
    FitAlone<Camera> fit = fitAloneFrom(camera, start.pinhole, data, planes, settings);
    const bool is_better = !best || fit.converged > best->converged ||
                           (fit.converged == best->converged && fit.rms_px < best->rms_px);
    if (is_better) best = std::move(fit);
  }
  best->start = start.source;
  return *best;
}

}  // namespace slom::calibration
