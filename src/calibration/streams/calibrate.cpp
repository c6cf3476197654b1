#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

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
constexpr double much_noise = 10;    ///< times the usual one
constexpr double far_off = 1.5;      ///< ratio of noise

double changeOf(const ImuNoise& before, const ImuNoise& after) {
  return std::max(std::abs(std::log(after.gyro / before.gyro)),
                  std::abs(std::log(after.force / before.force)));
}

/// Notes how far the IMUs have moved the parameters of the cameras, in standard deviations of the cameras' own fit.
void addCameraChange(const Result& cameras, const CamerasStart& now, StreamResult& result) {
  result.largest_camera_change = 0;
  const auto note = [&](const std::string& name, double change, double std) {
    if (!(std > 0) || !(std::abs(change) / std > result.largest_camera_change)) return;
    result.largest_camera_change = std::abs(change) / std;
    result.most_changed = name;
  };
  const double scale = std::sqrt(cameras.chi2PerDof());
  const std::vector<Lens>& lenses = now.lenses;
  const std::vector<SE3>& left2camera = now.rig.left2camera;
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
  if (!fitted.noise_is_given) {
    const double times =
        std::max(fitted.noise.gyro / usual_noise.gyro, fitted.noise.force / usual_noise.force);
    if (times > much_noise)
      result.notes.push_back(fmt::format(
          "The readings of {} fit the motion of the cameras as if they had {:.2g} times the noise of a usual sensor: "
          "check the size of the board, and whether the IMU is fixed to the cameras.",
          imu.name, times));
    return;
  }
  if (most < far_off && least > 1 / far_off) return;
  result.notes.push_back(fmt::format(
      "The residuals of {}'s gyroscope are {:.2g} and those of its accelerometer {:.2g} times what the given noise "
      "predicts; without --imu-noise, the noise is estimated.",
      imu.name, fitted.gyro_ratio, fitted.force_ratio));
}

/// Says if cameras and IMU contradict each other.
void addContradiction(StreamResult& result) {
  if (!(result.largest_camera_change > contradiction)) return;
  result.notes.push_back(fmt::format(
      "With the readings of the IMU, {} is {:.2g} standard deviations from its value by the images alone: images and "
      "readings contradict each other, for example by a board of another size than stated, or by errors that corners of an image "
      "share.",
      result.most_changed, result.largest_camera_change));
}

/// What a fit begins with.
struct Stage {
  Settings settings;
  CamerasStart cameras;
  std::vector<StartedImu> imus;
  mtk::S2<> up;
};

/// Returns the settings of the joint fit: `data` then have the corners where the cameras' fit put them, at the time of
/// their image.
Settings settingsOfStreams(const Settings& given, const Result& cameras) {
  Settings settings = started(given);
  settings.board_shape = BoardShape::flat;
  settings.rolling_shutter = false;
  settings.sigma_denominator = cameras.sigma_denominator;
  settings.sigma_px = given.sigma_px * std::sqrt(cameras.chi2PerDof());
  return settings;
}

std::vector<StartedImu> startImus(const std::vector<ImuStream>& imus, const std::vector<RigAtImage>& images,
                                  std::int64_t epoch_ns, const StreamSettings& stream) {
  std::vector<StartedImu> all;
  for (const ImuStream& imu : imus) {
    requireGoodStream(imu);
    std::optional<double> offset = stream.time_offset;
    if (offset) *offset -= double(imu.epoch_ns - epoch_ns) * 1e-9;
    all.push_back({&imu, startByRates(imu, images, offset), imu.noise.value_or(usual_noise)});
    requireForcesOfMotion(imu, images, all.back().start);
  }
  return all;
}

/// Estimates the noise of corners and readings in turn with the values, until it stays the same. Corners are at least as
/// noisy as the cameras' own fit found them. If a fit fails, the stage stays as it is.
void estimateNoise(const Dataset& data, const std::vector<RigAtImage>& images, Options options,
                   double gravity, Stage& stage) {
  const double least_px = stage.settings.sigma_px;
  options.deviation_tolerance = 0.1;
  for (int round = 0; round < most_rounds && reasonToEnd(stage.settings.limits).empty(); ++round) {
    StreamProblem problem(data, stage.settings, stage.cameras, images, stage.up, stage.imus, gravity);
    if (!problem.optimize(options).converged) return;
    const double sigma_px = std::max(least_px, stage.settings.sigma_px * limited(problem.imageRatio()));
    double change = std::abs(std::log(sigma_px / stage.settings.sigma_px));
    std::vector<StartedImu> imus = problem.restarted();
    for (std::size_t i = 0; i < imus.size(); ++i)
      change = std::max(change, changeOf(stage.imus[i].noise, imus[i].noise));
    stage = {stage.settings, problem.cameras(), std::move(imus), problem.up()};
    stage.settings.sigma_px = sigma_px;
    if (change < least_change) return;
  }
}

}  // namespace

StreamResult calibrateStreams(const Dataset& data, const Settings& given, const Result& cameras,
                              const std::vector<ImuStream>& imus, const StreamSettings& stream) {
  if (!cameras.success())
    throw DataError("slom.calibration.no-result", "the cameras' own calibration did not succeed", "cameras");
  if (imus.empty())
    throw DataError("slom.calibration.bad-stream", "there are no readings; give at least one IMU", "imus");
  const SortedDataset sorted(data);
  const Dataset accepted = asFitted(cameras, withoutRejected(*sorted, cameras));
  const DataOnBoard on_board(accepted, cameras.board);
  std::int64_t epoch_ns = 0;
  const std::vector<RigAtImage> images = rigAtImages(*on_board, cameras, epoch_ns);
  Stage stage{
      settingsOfStreams(given, cameras), startOf(cameras), startImus(imus, images, epoch_ns, stream), {}};
  stage.up = upByForces(imus.front(), images, stage.imus.front().start);
  Options options = optionsOf(stage.settings);
  options.most_parameters = 0;
  try {
    estimateNoise(*on_board, images, options, stream.gravity, stage);
  } catch (const slom::Error&) {
    // The data leave something open, which the result says.
  }
  StreamProblem problem(*on_board, stage.settings, stage.cameras, images, stage.up, stage.imus,
                        stream.gravity);
  StreamResult result = problem.result(problem.optimize(options));
  result.sigma_px = stage.settings.sigma_px;
  addCameraChange(cameras, problem.cameras(), result);
  for (std::size_t i = 0; i < imus.size(); ++i) {
    addNotes(imus[i], result.imus[i], result);
    result.imus[i].time_offset += double(imus[i].epoch_ns - epoch_ns) * 1e-9;
  }
  addContradiction(result);
  return result;
}

}  // namespace slom::calibration
