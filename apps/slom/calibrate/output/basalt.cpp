// Basalt's calibration.json.
//   source   https://gitlab.com/VladyslavUsenko/basalt-headers, calibration.hpp and calib_bias.hpp
#include <cmath>

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "calibrate/output/formats.hpp"

namespace slom::app::calib {
namespace {

using Json = nlohmann::ordered_json;

Json placeJson(const SE3& T) {
  return {{"px", T.pos[0]},     {"py", T.pos[1]},     {"pz", T.pos[2]},    {"qx", T.orient.x()},
          {"qy", T.orient.y()}, {"qz", T.orient.z()}, {"qw", T.orient.w()}};
}

Json lensJson(const ForeignLens& lens) {
  std::vector<const char*> names{"fx", "fy", "cx", "cy"};
  if (lens.camera_model == "kb4")
    names.insert(names.end(), {"k1", "k2", "k3", "k4"});
  else if (lens.camera_model == "ds")
    names.insert(names.end(), {"xi", "alpha"});
  else
    names.insert(names.end(), {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  Json intrinsics = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) intrinsics[names[i]] = lens.intrinsics[i];
  return {{"camera_type", lens.camera_model}, {"intrinsics", std::move(intrinsics)}};
}

/// Returns bias and scale as Basalt applies them: calibrated = (I + S) reading - bias.
std::pair<Eigen::Vector3d, Eigen::Matrix3d> inverted(const Eigen::Matrix3d& axes, const vec3& bias) {
  const Eigen::Matrix3d inverse = axes.inverse();
  return {inverse * bias, inverse - Eigen::Matrix3d::Identity()};
}

}  // namespace

std::string toBasaltJson(const Result& result, const ImuStreamResult& imu) {
  Json poses = Json::array(), lenses = Json::array(), sizes = Json::array();
  for (const CameraResult& camera : result.cameras) {
    poses.push_back(placeJson(imu.left2imu * camera.left2camera.inverse()));
    lenses.push_back(lensJson(lensFor(OutputFormat::basalt, camera)));
    sizes.push_back({camera.image_size->width, camera.image_size->height});
  }
  const ImuModel<>& model = imu.axes.model;
  const auto& a = model.force_axes;
  const auto& g = model.gyro_axes;
  const auto [force_bias, force] =
      inverted((Eigen::Matrix3d() << 1 + a[0], 0, 0, a[1], 1 + a[2], 0, a[3], a[4], 1 + a[5]).finished(),
               imu.force_bias);
  const auto [gyro_bias, gyro] = inverted(
      (Eigen::Matrix3d() << 1 + g[0], g[1], g[2], g[3], 1 + g[4], g[5], g[6], g[7], 1 + g[8]).finished(),
      imu.gyro_bias);
  Json accelerometer{force_bias[0], force_bias[1], force_bias[2], force(0, 0), force(1, 0),
                     force(2, 0),   force(1, 1),   force(2, 1),   force(2, 2)};
  Json gyroscope{gyro_bias[0], gyro_bias[1], gyro_bias[2]};
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) gyroscope.push_back(gyro(row, column));
  }
  const auto each = [](double value) { return Json{value, value, value}; };
  const Json value{{"T_imu_cam", std::move(poses)},
                   {"intrinsics", std::move(lenses)},
                   {"resolution", std::move(sizes)},
                   {"calib_accel_bias", std::move(accelerometer)},
                   {"calib_gyro_bias", std::move(gyroscope)},
                   {"imu_update_rate", imu.rate},
                   {"accel_noise_std", each(imu.noise.force)},
                   {"gyro_noise_std", each(imu.noise.gyro)},
                   {"accel_bias_std", each(imu.noise.force_walk)},
                   {"gyro_bias_std", each(imu.noise.gyro_walk)},
                   {"cam_time_offset_ns", std::llround(1e9 * imu.time_offset)},
                   {"vignette", Json::array()}};
  return Json{{"value0", value}}.dump(2) + "\n";
}

}  // namespace slom::app::calib
