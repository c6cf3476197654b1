#include "calibrate/fit/calibration.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrate/fit/joint.hpp"
#include "calibrate/input/check.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

/// Fewer numbers measured than unknown: nothing to fit.
void requireEnoughMeasurements(const Dataset& data, const Settings& settings, int parameters_per_camera) {
  std::size_t measured = 0;
  for (const CameraData& camera : data.cameras) measured += 2 * camera.cornerCount();
  const std::size_t cameras = data.cameras.size();
  std::size_t fixed = 0;
  for (const LensConstraint& constraint : settings.lens) fixed += constraint.isFixed() ? (constraint.camera.empty() ? cameras : 1) : 0;
  const std::size_t unknowns = cameras * parameters_per_camera - fixed + 6 * (cameras - 1) + 6 * data.images().size();
  if (measured > unknowns) return;
  throw UserError(
      fmt::format("{}:2: the corners give {} numbers for {} unknowns of the model {}; add images or "
                  "corners, or choose a model with fewer parameters by --intrinsics",
                  data.cameras.front().file, measured, unknowns, toString(settings.model)));
}

/// Views that lie more than 10 px, and ten times as far as most, from where the rig puts them: in most cases
/// images that were not taken at the same time.
template <class Camera>
std::vector<Stray> findStrays(const Dataset& data, const std::vector<Camera>& cameras, const RigStart& rig) {
  std::vector<Stray> views;
  std::vector<double> errors;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (const View& view : data.cameras[c].views) {
      const SE3 world2camera = rig.left2camera[c] * rig.left2world.at(view.image).inverse();
      const double square = squaredPixelError(cameras[c], world2camera, view);
      errors.push_back(std::sqrt(square / double(view.corners.size())));
      views.push_back({data.cameras[c].name, view.image, errors.back()});
    }
  }
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  const double limit = std::max(10.0, 10 * errors[errors.size() / 2]);
  std::erase_if(views, [&](const Stray& view) { return view.error_px <= limit; });
  return views;
}

template <class Camera>
Result calibrateModel(const Dataset& data, const Settings& settings, const Progress& progress) {
  requireEnoughMeasurements(data, settings, Camera::DOF);
  std::vector<Camera> cameras;
  std::vector<ViewPoses> world2camera;
  std::vector<double> rms_px_alone;
  for (const CameraData& camera : data.cameras) {
    const auto fit = fitAlone<Camera>(camera, settings);
    cameras.push_back(fit.camera);
    world2camera.push_back(fit.world2camera);
    rms_px_alone.push_back(fit.converged ? fit.rms_px : unknown);
    if (progress.alone) progress.alone({&camera, fit.start, fit.converged, fit.iterations, fit.rms_px});
  }
  const RigStart rig = startRig(data, world2camera);

  std::optional<ImuStart> imu;
  std::vector<TiltPair> tilts;
  if (data.imu) {
    tilts = tiltPairs(*data.imu, rig.left2world);
    imu = startImu(tilts, settings.fixed, settings.sigma_acc);
    requireImuDetermined(*data.imu, tilts, *imu, settings.fixed, settings.sigma_acc);
  }

  JointProblem<Camera> problem(data, settings, cameras, rig, imu);
  Options options;
  options.max_iterations = settings.max_iterations;
  options.observer = progress.iteration;
  Result result = problem.result(problem.optimize(options));
  for (std::size_t c = 0; c < cameras.size(); ++c) result.cameras[c].rms_px_alone = rms_px_alone[c];
  result.strays = findStrays(data, cameras, rig);
  if (imu) {
    result.imu->tilt_spread = tiltSpread(tilts);
    result.imu->sign_evidence = imu->sign_evidence;
  }
  return result;
}

template <class Camera>
Result calibrateModelFrom(const Result& start, const Dataset& data, const Settings& settings) {
  requireEnoughMeasurements(data, settings, Camera::DOF);
  std::vector<Camera> cameras;
  RigStart rig;
  for (const CameraResult& camera : start.cameras) {
    cameras.emplace_back();
    for (int i = 0; i < Camera::DOF; ++i) cameras.back()[i] = camera.parameters[std::size_t(i)].value;
    rig.left2camera.push_back(camera.left2camera);
  }
  const std::vector<int> wanted = data.images();
  for (const ImageResult& image : start.images) {
    if (std::binary_search(wanted.begin(), wanted.end(), image.image)) rig.left2world[image.image] = image.left2world;
  }
  JointProblem<Camera> problem(data, settings, cameras, rig, {});
  Options options;
  options.max_iterations = settings.max_iterations;
  options.most_parameters = 0;
  return problem.result(problem.optimize(options));
}

/// f<Camera>() for the camera type of a model.
template <class F>
Result withModel(Model model, const F& f) {
  switch (model) {
    case Model::opencv5:
      return f.template operator()<Opencv5<>>();
    case Model::opencv4:
      return f.template operator()<Opencv4<>>();
    case Model::radial1:
      return f.template operator()<Radial1<>>();
  }
  throw std::logic_error("slom calibrate: unknown model");
}

}  // namespace

std::string sentenceOf(const slom::Error& error) {
  const std::string text = error.what();
  const std::size_t id_end = text.find("] ");
  const std::size_t begin = id_end == std::string::npos ? 0 : id_end + 2;
  return text.substr(begin, text.find_first_of(":;", begin) - begin);
}

Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress) {
  checkDataset(data);
  return withModel(settings.model, [&]<class Camera>() { return calibrateModel<Camera>(data, settings, progress); });
}

Result calibrateFrom(const Result& start, const Dataset& data, const Settings& settings) {
  checkDataset(data);
  return withModel(settings.model, [&]<class Camera>() { return calibrateModelFrom<Camera>(start, data, settings); });
}

}  // namespace slom::app::calib
