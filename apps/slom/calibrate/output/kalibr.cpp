// Kalibr's camchain.
//   source   https://github.com/ethz-asl/kalibr/wiki/yaml-formats
#include "calibrate/output/formats.hpp"
#include "calibrate/output/yaml_text.hpp"

namespace slom::app::calib {
namespace {

void addPose(YAML::Emitter& yaml, const char* name, const SE3& pose) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = pose.orient.toRotationMatrix();
  T.topRightCorner<3, 1>() = pose.pos;
  yaml << YAML::Key << name << YAML::Value << YAML::BeginSeq;
  for (int row = 0; row < 4; ++row) yaml << numbers(T.row(row).transpose());
  yaml << YAML::EndSeq;
}

}  // namespace

std::string toKalibrYaml(const Result& result, const StreamResult* streams) {
  const ImuStreamResult* const imu = streams ? &streams->imus.front() : nullptr;
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  for (std::size_t n = 0; n < result.cameras.size(); ++n) {
    const CameraResult& camera = result.cameras[n];
    const ForeignLens lens = lensFor(OutputFormat::kalibr, camera);
    yaml << YAML::Key << "cam" + std::to_string(n) << YAML::Value << YAML::BeginMap
         << YAML::Comment(camera.name);
    if (imu) {
      addPose(yaml, "T_cam_imu", camera.left2camera * imu->left2imu.inverse());
      yaml << YAML::Key << "timeshift_cam_imu" << YAML::Value << fmt::format("{}", offsetOf(*streams, n));
    }
    if (n > 0) addPose(yaml, "T_cn_cnm1", camera.left2camera * result.cameras[n - 1].left2camera.inverse());
    yaml << YAML::Key << "camera_model" << YAML::Value << lens.camera_model << YAML::Key << "intrinsics"
         << YAML::Value << numbers(lens.intrinsics) << YAML::Key << "distortion_model" << YAML::Value
         << lens.distortion_model << YAML::Key << "distortion_coeffs" << YAML::Value
         << numbers(lens.distortion) << YAML::Key << "resolution" << YAML::Value
         << numbers(Eigen::Vector2d(camera.image_size->width, camera.image_size->height)) << YAML::EndMap;
  }
  yaml << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace slom::app::calib
