// The moving rig of `slom simulate stereo-imu-stream`, in memory.
#pragma once

#include <map>
#include <vector>

#include <slom/calibration.hpp>

#include "simulate/stereo_imu_stream.hpp"

namespace slom::calibration::testing {

/// Returns a short recording that is calibrated quickly: 2 x 2 large tags, 10 images per second.
inline app::StereoImuStreamOptions quickStream(std::uint64_t seed, double seconds = 6) {
  app::StereoImuStreamOptions options;
  options.seed = seed;
  options.seconds = seconds;
  options.camera_rate = 10;
  options.tags = 2;
  options.square_m = 0.24;
  options.spacing = 0.6;
  return options;
}

/// Returns the corners of the first `cameras` cameras; images are numbered in the order of time, from 1.
inline Dataset datasetOf(const app::StereoImuStreamOptions& options,
                         const app::StereoImuStreamData& simulated, int cameras = 1) {
  std::map<std::int64_t, int> number;
  for (int c = 0; c < cameras; ++c) {
    for (const app::StreamCorner& corner : simulated.corners[c]) number[corner.time_ns] = 0;
  }
  int last = 0;
  for (auto& [time, image] : number) image = ++last;
  Dataset data;
  for (int c = 0; c < cameras; ++c) {
    CameraData camera{
        "cam" + std::to_string(c), "", {}, ImageSize{simulated.image_width_px, simulated.image_height_px}};
    for (const app::StreamCorner& corner : simulated.corners[c]) {
      const int image = number.at(corner.time_ns);
      if (camera.views.empty() || camera.views.back().image != image) {
        camera.views.push_back({image, {}});
        camera.views.back().time_ns = corner.time_ns;
      }
      camera.views.back().corners.push_back(
          {corner.corner, app::streamCornerInWorld(options, corner.corner), corner.pixel});
    }
    data.cameras.push_back(std::move(camera));
  }
  return data;
}

/// Returns the readings, without their noise.
inline ImuStream streamOf(const app::StereoImuStreamData& simulated, const std::string& name = "imu0") {
  ImuStream stream;
  stream.name = name;
  stream.epoch_ns = simulated.imu_epoch_ns;
  stream.samples = simulated.imu;
  return stream;
}

/// A simulated recording and its calibration.
struct Calibrated {
  explicit Calibrated(const app::StereoImuStreamOptions& given, int cameras = 1)
      : options(given),
        simulated(app::simulateStereoImuStream(given)),
        data(datasetOf(given, simulated, cameras)) {
    settings.sigma_px = options.sigma_px;
    camera = calibrate(data, settings);
  }
  ImuStream stream() const {
    ImuStream imu = streamOf(simulated);
    imu.noise = options.noise;
    return imu;
  }
  StreamResult with(const std::vector<ImuStream>& imus, const StreamSettings& stream = {}) const {
    return calibrateStreams(data, settings, camera, imus, stream);
  }

  app::StereoImuStreamOptions options;
  app::StereoImuStreamData simulated;
  Dataset data;
  Settings settings;
  Result camera;
};

}  // namespace slom::calibration::testing
