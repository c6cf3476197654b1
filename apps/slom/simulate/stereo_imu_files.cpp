#include "simulate/stereo_imu_files.hpp"

#include <string>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "error.hpp"
#include "output_files.hpp"

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

Json vectorJson(const mtk::vect<3>& v) { return {v.x(), v.y(), v.z()}; }

Json rotationJson(const mtk::SO3<>& rotation) {
  Json rows = Json::array();
  const auto R = rotation.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rows.push_back(R(i, j));
  }
  return rows;
}

Json poseJson(const mtk::trafo<mtk::SO3<>>& pose) {
  return {{"rotation", rotationJson(pose.orient)}, {"translation", vectorJson(pose.pos)}};
}

Json cameraJson(const SimulatedCamera& camera, const mtk::trafo<mtk::SO3<>>& pose_from_left) {
  Json parameters;
  const auto add = [&](const char* name, double value) { parameters[name]["value"] = value; };
  add("fx", camera.fx), add("fy", camera.fy), add("cx", camera.cx), add("cy", camera.cy);
  add("k1", camera.k1), add("k2", camera.k2), add("p1", camera.p1), add("p2", camera.p2),
      add("k3", camera.k3);
  return {{"model", "opencv5"}, {"parameters", parameters}, {"pose_from_left", poseJson(pose_from_left)}};
}

std::string truthJson(const StereoImuTruth& truth, const StereoImuOptions& options) {
  Json json;
  json["simulation"] = {{"seed", options.seed},
                        {"images", options.images},
                        {"sigma_px", options.sigma_px},
                        {"sigma_acc", options.sigma_acc},
                        {"image_size_px", {truth.image_width_px, truth.image_height_px}}};
  json["cameras"]["left"] = cameraJson(truth.left, {});
  json["cameras"]["right"] = cameraJson(truth.right, truth.left2right);
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
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw UserError(fmt::format("cannot make the folder {}: {}; give --output a folder that can be written",
                                folder.string(), error ? error.message() : "something else has this name"));
  }
  OutputFiles files;
  files.add(folder / "left_corners.csv", cornersCsv(data.left));
  files.add(folder / "right_corners.csv", cornersCsv(data.right));
  files.add(folder / "imu.csv", imuCsv(data.imu));
  files.add(folder / "truth.json", truthJson(data.truth, options));
  files.commit();
}

}  // namespace slom::app
