#include "calibration/streams/joint_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calibration/fit/rig.hpp"
#include "calibration/limits.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/doubt.hpp"
#include "calibration/streams/forces.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

/// Densities to begin with if the caller gives none: those of a good MEMS sensor.
constexpr ImuNoise usual_noise{2e-4, 2e-3, 2e-5, 5e-4};

constexpr double contradiction = 5;    ///< standard deviations
constexpr double much_noise = 10;      ///< times the usual one
constexpr double far_off_ratio = 1.5;  ///< ratio of noise

/// Notes how far the IMUs have moved the parameters of the cameras, in standard deviations of the cameras' own fit.
void addCameraChange(const Result& cameras, const CamerasAt& now, StreamResult& result) {
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

constexpr const char* causes_of_misfit =
    "check whether the IMU is fixed to the cameras, the size of the board, and whether its clock drifts, its bias jumps or "
    "readings are missing";

/// Says what the stream lacks, and whether its noise is as stated.
void addNotes(const ImuStream& imu, const ImuStreamResult& fitted, StreamResult& result) {
  noteFaults(imu, result);
  const double most = std::max(fitted.gyro_ratio, fitted.force_ratio),
               least = std::min(fitted.gyro_ratio, fitted.force_ratio);
  if (!fitted.noise_is_given) {
    const double times =
        std::max(fitted.noise.gyro / usual_noise.gyro, fitted.noise.force / usual_noise.force);
    if (times > much_noise)
      addDoubt(
          fmt::format(
              "the readings of {} fit the motion of the cameras as if they had {:.2g} times the noise of a usual sensor",
              imu.name, times),
          std::string(causes_of_misfit) + ".", result);
    return;
  }
  if (most < far_off_ratio && least > 1 / far_off_ratio) return;
  const std::string fault = fmt::format(
      "residuals of {}'s gyroscope are {:.2g} and those of its accelerometer {:.2g} times what the given noise predicts",
      imu.name, fitted.gyro_ratio, fitted.force_ratio);
  if (most < far_off_ratio)
    result.notes.push_back("The " + fault + ": without --imu-noise, the noise is estimated.");
  else
    addDoubt("the " + fault,
             std::string(causes_of_misfit) +
                 ". If none applies, the sensor is noisier than stated: leave out --imu-noise, "
                 "and the noise is estimated.",
             result);
}

/// Says if cameras and IMU contradict each other.
void addContradiction(StreamResult& result) {
  if (!(result.largest_camera_change > contradiction)) return;
  addDoubt(
      fmt::format(
          "with the readings of the IMU, {} is {} standard deviations from its value by the images alone",
          result.most_changed, twoDigits(result.largest_camera_change)),
      "images and readings contradict each other, for example by a board of another size than stated, or by errors "
      "that corners of an image share.",
      result);
}

}  // namespace

Settings settingsOfStreams(const Settings& given, const Result& cameras) {
  Settings settings = started(given);
  settings.board_shape = BoardShape::flat;
  settings.rolling_shutter = false;
  settings.sigma_denominator = cameras.sigma_denominator;
  settings.sigma_px = given.sigma_px * std::sqrt(cameras.chi2PerDof());
  return settings;
}

Options optionsOfStreams(const Settings& settings) {
  Options options = optionsOf(settings);
  options.most_parameters = 0;
  return options;
}

std::vector<StartedImu> startImus(const std::vector<ImuStream>& imus, const std::vector<RigAtImage>& images,
                                  std::int64_t epoch_ns, const StreamSettings& stream) {
  std::vector<StartedImu> all;
  for (const ImuStream& imu : imus) {
    std::optional<double> offset = stream.time_offset;
    if (offset) *offset -= double(imu.epoch_ns - epoch_ns) * 1e-9;
    all.push_back({&imu, startByRates(imu, images, offset), imu.noise.value_or(usual_noise)});
    all.back().axes = stream.axes;
    requireForcesOfMotion(imu, images, all.back().start);
  }
  return all;
}

double excessOf(const StreamResult& result) {
  double most = 0;
  for (const ImuStreamResult& imu : result.imus) {
    const double gyro = imu.noise.gyro / usual_noise.gyro, force = imu.noise.force / usual_noise.force;
    most = std::max(most, imu.noise_is_given
                              ? std::max(imu.gyro_ratio, imu.force_ratio) / far_off_ratio
                              : std::max(gyro * imu.gyro_ratio, force * imu.force_ratio) / much_noise);
  }
  return most;
}

void completeResult(const Result& cameras, const CamerasAt& fitted, const std::vector<ImuStream>& imus,
                    std::int64_t epoch_ns, bool is_comparable, StreamResult& result) {
  addCameraChange(cameras, fitted, result);
  for (std::size_t i = 0; i < imus.size(); ++i) {
    addNotes(imus[i], result.imus[i], result);
    result.imus[i].time_offset += double(imus[i].epoch_ns - epoch_ns) * 1e-9;
  }
  if (is_comparable) addContradiction(result);
}

}  // namespace slom::calibration
