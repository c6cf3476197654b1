#include "simulate/stereo_imu_files.hpp"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "output_files.hpp"
#include "simulate/folder.hpp"
#include "simulate/truth_json.hpp"

namespace slom::app {

namespace {

using Json = nlohmann::ordered_json;

std::string cornersCsv(const std::vector<SimulatedCorner>& corners) {
  std::string text = "image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\n";
  for (const SimulatedCorner& c : corners) {
    text += fmt::format("{},{},{:g},{:g},{:g},{:.9f},{:.9f}\n", c.image, c.corner, c.world.x(), c.world.y(),
                        c.world.z(), c.pixel.x(), c.pixel.y());
  }
  return text;
}

std::string imuCsv(const std::vector<SimulatedAcceleration>& imu) {
  std::string text = "image,ax_m_s2,ay_m_s2,az_m_s2,valid\n";
  for (const SimulatedAcceleration& a : imu) {
    if (a.valid) {
      text +=
          fmt::format("{},{:.9f},{:.9f},{:.9f},1\n", a.image, a.reading.x(), a.reading.y(), a.reading.z());
    } else {
      text += fmt::format("{},0,0,0,0\n", a.image);
    }
  }
  return text;
}

std::string truthJson(const StereoImuTruth& truth, const StereoImuOptions& options) {
  Json json;
  json["simulation"] = {{"seed", options.seed},
                        {"images", options.images},
                        {"sigma_px", options.sigma_px},
                        {"sigma_acc", options.sigma_acc},
                        {"image_size_px", {truth.image_width_px, truth.image_height_px}}};
  json["cameras"]["left"] = cameraJson(truth.left, "pose_from_left", {});
  json["cameras"]["right"] = cameraJson(truth.right, "pose_from_left", truth.left2right);
  json["imu"] = {{"rotation_from_left", rotationJson(truth.left2imu)},
                 {"acc_bias", vectorJson(truth.acc_bias)},
                 {"gravity", truth.gravity}};
  for (std::size_t i = 0; i < truth.left2world.size(); ++i) {
    json["left2world"][std::to_string(i + 1)] = poseJson(truth.left2world[i]);
  }
  return json.dump(2) + "\n";
}

}  // namespace

void writeStereoImu(const StereoImuData& data, const StereoImuOptions& options,
                    const std::filesystem::path& folder) {
  makeFolder(folder);
  OutputFiles files;
  files.add(folder / "left_corners.csv", cornersCsv(data.left));
  files.add(folder / "right_corners.csv", cornersCsv(data.right));
  files.add(folder / "imu.csv", imuCsv(data.imu));
  files.add(folder / "truth.json", truthJson(data.truth, options));
  files.commit();
}

}  // namespace slom::app
