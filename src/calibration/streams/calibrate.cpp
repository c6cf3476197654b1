#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/limits.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/forces.hpp"
#include "calibration/streams/problem.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {
namespace {

/// Returns the rig at all images, in the order of time, and the time of zero in the clock of the cameras.
std::vector<RigAtImage> rigAtImages(const Dataset& data, const Result& cameras, std::int64_t& epoch_ns) {
  std::map<int, std::int64_t> times;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      if (!view.time_ns)
        throw DataError(
            "slom.calibration.bad-stream",
            {.place = nameOf(camera),
             .fault = fmt::format("image {} has no time", view.image),
             .remedy = "give corner files with a column t_ns, or photographs whose names are times in ns"});
      times.emplace(view.image, *view.time_ns);
    }
  }
  epoch_ns = times.begin()->second;
  for (const auto& [image, time] : times) epoch_ns = std::min(epoch_ns, time);
  std::vector<RigAtImage> images;
  for (const ImageResult& image : cameras.images) {
    const auto time = times.find(image.image);
    if (time != times.end())
      images.push_back({image.image, double(time->second - epoch_ns) * 1e-9, image.left2world});
  }
  std::sort(images.begin(), images.end(),
            [](const RigAtImage& a, const RigAtImage& b) { return a.time < b.time; });
  return images;
}

/// Densities to begin with if the caller gives none: those of a good MEMS sensor.
constexpr ImuNoise usual_noise{2e-4, 2e-3, 2e-5, 5e-4};

/// Rounds of fits in which the noise of corners and readings is estimated in turn with the values, and the relative
/// change of a standard deviation at which they end.
constexpr int most_rounds = 20;
constexpr double least_change = 0.02;

constexpr double contradiction = 5;  ///< standard deviations
constexpr double far_off = 1.5;      ///< ratio of noise

double changeOf(const ImuNoise& before, const ImuNoise& after) {
  return std::max(std::abs(std::log(after.gyro / before.gyro)),
                  std::abs(std::log(after.force / before.force)));
}

/// Notes how far the IMUs have moved the parameters of the cameras, in standard deviations of the cameras' own fit.
void addCameraChange(const Result& cameras, RigProblem& rig, StreamResult& result) {
  result.largest_camera_change = 0;
  const auto note = [&](const std::string& name, double change, double std) {
    if (!(std > 0) || !(std::abs(change) / std > result.largest_camera_change)) return;
    result.largest_camera_change = std::abs(change) / std;
    result.most_changed = name;
  };
  const double scale = std::sqrt(cameras.chi2PerDof());
  const std::vector<Lens> lenses = rig.cameras();
  const std::vector<SE3> left2camera = rig.rig().left2camera;
  for (std::size_t c = 0; c < lenses.size(); ++c) {
    const CameraResult& camera = cameras.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
      const Parameter& p = camera.parameters[i];
      note(camera.name + "." + p.name, lenses[c][int(i)] - p.value, scale * p.std);
    }
    const vec3 turn = SO3::log(camera.left2camera.orient.inverse() * left2camera[c].orient);
    for (int i = 0; i < 3; ++i) {
      const char axis = "xyz"[i];
      note(camera.name + ".translation." + axis, left2camera[c].pos[i] - camera.left2camera.pos[i],
           scale * camera.translation_std[i]);
      note(camera.name + ".rotation." + axis, turn[i], scale * camera.rotation_std[i]);
    }
  }
}

/// Says what the stream lacks, and whether its noise is as stated.
void addNotes(const ImuStream& imu, const ImuStreamResult& fitted, StreamResult& result) {
  for (std::string& note : notesOf(imu)) result.notes.push_back(std::move(note));
  const double most = std::max(fitted.gyro_ratio, fitted.force_ratio),
               least = std::min(fitted.gyro_ratio, fitted.force_ratio);
  if (!fitted.noise_is_given || (most < far_off && least > 1 / far_off)) return;
  result.notes.push_back(fmt::format(
      "The residuals of {}'s gyroscope are {:.2g} and those of its accelerometer {:.2g} times what the given noise "
      "predicts; without --imu-noise, the noise is estimated.",
      imu.name, fitted.gyro_ratio, fitted.force_ratio));
}

}  // namespace

StreamResult calibrateStreams(const Dataset& data, const Settings& given, const Result& cameras,
                              const std::vector<ImuStream>& imus, const StreamSettings& stream) {
  if (!cameras.success())
    throw DataError("slom.calibration.no-result", "the cameras' own calibration did not succeed", "cameras");
  const SortedDataset sorted(data);
  const Dataset accepted = asFitted(cameras, withoutRejected(*sorted, cameras));
  const DataOnBoard on_board(accepted, cameras.board);
  Settings settings = started(given);
  settings.board_shape = BoardShape::flat;  // at the places that the cameras' fit gave the corners
  settings.rolling_shutter = false;         // asFitted has moved the pixels back
  settings.sigma_denominator = cameras.sigma_denominator;
  settings.sigma_px = given.sigma_px * std::sqrt(cameras.chi2PerDof());
  std::int64_t epoch_ns = 0;
  const std::vector<RigAtImage> images = rigAtImages(*on_board, cameras, epoch_ns);
  std::vector<StartedImu> started_imus;
  std::optional<mtk::S2<>> up;
  for (const ImuStream& imu : imus) {
    requireGoodStream(imu);
    std::optional<double> offset = stream.time_offset;
    if (offset) *offset -= double(imu.epoch_ns - epoch_ns) * 1e-9;
    StartedImu one{&imu, startByRates(imu, images, offset), imu.noise.value_or(usual_noise)};
    requireForcesOfMotion(imu, images, one.start);
    if (!up) up = upByForces(imu, images, one.start);
    started_imus.push_back(one);
  }
  Options options = optionsOf(settings);
  options.most_parameters = 0;
  Options quick = options;
  quick.deviation_tolerance = 0.1;
  for (int round = 0; round < most_rounds; ++round) {
    StreamProblem rough(*on_board, settings, cameras, images, *up, started_imus, stream.gravity);
    if (!rough.optimize(quick).converged) break;
    const std::vector<StartedImu> next = rough.restarted();
    const double ratio = rough.imageRatio();
    double change = std::abs(std::log(ratio));
    for (std::size_t i = 0; i < imus.size(); ++i)
      change = std::max(change, changeOf(started_imus[i].noise, next[i].noise));
    settings.sigma_px *= ratio;
    started_imus = next;
    up = rough.up();
    if (change < least_change) break;
  }
  StreamProblem problem(*on_board, settings, cameras, images, *up, started_imus, stream.gravity);
  const Summary summary = problem.optimize(options);
  StreamResult result = problem.result(summary);
  result.sigma_px = settings.sigma_px;
  addCameraChange(cameras, problem.rig(), result);
  for (std::size_t i = 0; i < imus.size(); ++i) addNotes(imus[i], result.imus[i], result);
  if (result.largest_camera_change > contradiction)
    result.notes.push_back(fmt::format(
        "With the readings of the IMU, {} is {:.2g} standard deviations from its value by the images alone: images and "
        "readings contradict each other, for example by errors that corners of an image share.",
        result.most_changed, result.largest_camera_change));
  for (std::size_t i = 0; i < imus.size(); ++i)
    result.imus[i].time_offset += double(imus[i].epoch_ns - epoch_ns) * 1e-9;
  return result;
}

}  // namespace slom::calibration
