#include "simulate/stereo_imu_stream_files.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "output_files.hpp"
#include "simulate/folder.hpp"
#include "simulate/truth_json.hpp"

namespace slom::app {

namespace {

using Json = nlohmann::ordered_json;

std::string cornersCsv(const std::vector<StreamCorner>& corners) {
  std::string text = "t_ns,corner,u_px,v_px\n";
  for (const StreamCorner& c : corners)
    text += fmt::format("{},{},{:.6f},{:.6f}\n", c.time_ns, c.corner, c.pixel.x(), c.pixel.y());
  return text;
}

std::string imuCsv(const StereoImuStreamData& data) {
  std::string text = "t_ns,wx_rad_s,wy_rad_s,wz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n";
  for (const ImuSample& s : data.imu) {
    text += fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                        data.imu_epoch_ns + std::llround(s.time * 1e9), s.gyro.x(), s.gyro.y(), s.gyro.z(),
                        s.force.x(), s.force.y(), s.force.z());
  }
  return text;
}

std::string imuYaml(const StereoImuStreamOptions& options) {
  return fmt::format(
      "gyroscope_noise_density: {:g}  # rad/s/sqrt(Hz)\n"
      "gyroscope_random_walk: {:g}  # rad/s^2/sqrt(Hz)\n"
      "accelerometer_noise_density: {:g}  # m/s^2/sqrt(Hz)\n"
      "accelerometer_random_walk: {:g}  # m/s^3/sqrt(Hz)\n"
      "update_rate: {:g}  # Hz\n",
      options.noise.gyro, options.noise.gyro_walk, options.noise.force, options.noise.force_walk,
      options.imu_rate);
}

std::string nameOf(SimulatedMotion motion) {
  switch (motion) {
    case SimulatedMotion::full:
      return "full";
    case SimulatedMotion::translation:
      return "translation";
    case SimulatedMotion::one_axis:
      return "one-axis";
    case SimulatedMotion::rest:
      return "rest";
  }
  return "";
}

Json timingJson(double offset, double line_delay) {
  return {{"time_offset_s", {{"value", offset}}}, {"line_delay_s", {{"value", line_delay}}}};
}

std::string truthJson(const StereoImuStreamData& data, const StereoImuStreamOptions& options) {
  Json json;
  json["simulation"] = {{"seed", options.seed},
                        {"seconds", options.seconds},
                        {"motion", nameOf(options.motion)},
                        {"sigma_px", options.sigma_px},
                        {"image_size_px", {data.image_width_px, data.image_height_px}}};
  json["cameras"]["cam0"] = cameraJson(data.cam0, "pose_from_cam0", {});
  json["cameras"]["cam1"] = cameraJson(data.cam1, "pose_from_cam0", data.cam0_to_cam1);
  json["imus"]["imu0"] = {{"pose_from_cam0", poseJson(options.cam0_to_imu)},
                          {"time_offset_s", {{"value", options.time_offset}}},
                          {"gyro_bias", vectorJson(data.gyro_bias)},
                          {"acc_bias", vectorJson(data.force_bias)},
                          {"noise",
                           {{"gyroscope_noise_density", options.noise.gyro},
                            {"gyroscope_random_walk", options.noise.gyro_walk},
                            {"accelerometer_noise_density", options.noise.force},
                            {"accelerometer_random_walk", options.noise.force_walk}}}};
  json["gravity"] = vectorJson(data.gravity);
  json["streams"]["cameras"] = {{"cam0", timingJson(0, options.line_delay)},
                                {"cam1", timingJson(options.camera_offset, options.line_delay)}};
  return json.dump(2) + "\n";
}

}  // namespace

void writeStereoImuStream(const StereoImuStreamData& data, const StereoImuStreamOptions& options,
                          const std::filesystem::path& folder) {
  makeFolder(folder);
  OutputFiles files;
  files.add(folder / "cam0_corners.csv", cornersCsv(data.corners[0]));
  files.add(folder / "cam1_corners.csv", cornersCsv(data.corners[1]));
  files.add(folder / "imu0.csv", imuCsv(data));
  files.add(folder / "imu.yaml", imuYaml(options));
  files.add(folder / "truth.json", truthJson(data, options));
  files.commit();
}

}  // namespace slom::app
