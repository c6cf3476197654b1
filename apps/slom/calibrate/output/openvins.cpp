// The files of OpenVINS: cameras with their poses on the IMU, and the IMU.
//   source   https://docs.openvins.com/gs-calibration.html, config/*/kalibr_imucam_chain.yaml
#include <Eigen/QR>

#include "calibrate/output/formats.hpp"
#include "calibrate/output/yaml_text.hpp"

namespace slom::app::calib {
namespace {

void addRows(YAML::Emitter& yaml, const char* name, const Eigen::MatrixXd& m) {
  yaml << YAML::Key << name << YAML::Value << YAML::BeginSeq;
  for (int row = 0; row < m.rows(); ++row) yaml << numbers(m.row(row).transpose());
  yaml << YAML::EndSeq;
}

Eigen::Matrix3d square(const mtk::vect<9>& a) {
  return (Eigen::Matrix3d() << a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8]).finished();
}

std::string fileText(const YAML::Emitter& yaml) {
  return "%YAML:1.0\n\n" + std::string(yaml.c_str()) + "\n";  // OpenCV's FileStorage wants this first line
}

}  // namespace

std::string toOpenvinsCameras(const Result& result, const StreamResult& streams) {
  const ImuStreamResult& imu = streams.imus.front();
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  for (std::size_t n = 0; n < result.cameras.size(); ++n) {
    const CameraResult& camera = result.cameras[n];
    const ForeignLens lens = lensFor(OutputFormat::openvins, camera);
    yaml << YAML::Key << "cam" + std::to_string(n) << YAML::Value << YAML::BeginMap
         << YAML::Comment(camera.name);
    const SE3 camera2imu = imu.left2imu * camera.left2camera.inverse();
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = camera2imu.orient.toRotationMatrix();
    T.topRightCorner<3, 1>() = camera2imu.pos;
    addRows(yaml, "T_imu_cam", T);
    Eigen::VectorXd others(Eigen::Index(result.cameras.size()) - 1);
    for (Eigen::Index i = 0; i < others.size(); ++i) others[i] = double(i) + (i >= Eigen::Index(n) ? 1 : 0);
    yaml << YAML::Key << "cam_overlaps" << YAML::Value << numbers(others) << YAML::Key << "camera_model"
         << YAML::Value << lens.camera_model << YAML::Key << "distortion_coeffs" << YAML::Value
         << numbers(lens.distortion) << YAML::Key << "distortion_model" << YAML::Value
         << lens.distortion_model << YAML::Key << "intrinsics" << YAML::Value << numbers(lens.intrinsics)
         << YAML::Key << "resolution" << YAML::Value
         << numbers(Eigen::Vector2d(camera.image_size->width, camera.image_size->height)) << YAML::Key
         << "rostopic" << YAML::Value << "/" + camera.name + "/image_raw" << YAML::Key << "timeshift_cam_imu"
         << YAML::Value << fmt::format("{}", offsetOf(streams, n)) << YAML::EndMap;
  }
  yaml << YAML::EndMap;
  return fileText(yaml);
}

std::string toOpenvinsImu(const ImuStreamResult& imu) {
  const ImuModel<>& model = imu.axes.model;
  const auto& a = model.force_axes;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d Ta =
      (Eigen::Matrix3d() << 1 + a[0], 0, 0, a[1], 1 + a[2], 0, a[3], a[4], 1 + a[5]).finished();
  // gyro_axes = Tw R with Tw lower triangular: the QR decomposition of the transpose, with a positive diagonal.
  const Eigen::HouseholderQR<Eigen::Matrix3d> qr((I + square(model.gyro_axes)).transpose());
  const Eigen::Matrix3d upper = qr.matrixQR().triangularView<Eigen::Upper>();
  const Eigen::DiagonalMatrix<double, 3> sign(upper.diagonal().cwiseSign());
  const Eigen::Matrix3d Tw = (sign * upper).transpose(),
                        R = (Eigen::Matrix3d(qr.householderQ()) * sign).transpose();
  YAML::Emitter yaml;
  yaml << YAML::BeginMap << YAML::Key << "imu0" << YAML::Value << YAML::BeginMap << YAML::Comment(imu.name);
  addRows(yaml, "T_i_b", Eigen::Matrix4d::Identity());
  for (const auto& [name, value] : {std::pair("accelerometer_noise_density", imu.noise.force),
                                    {"accelerometer_random_walk", imu.noise.force_walk},
                                    {"gyroscope_noise_density", imu.noise.gyro},
                                    {"gyroscope_random_walk", imu.noise.gyro_walk}})
    yaml << YAML::Key << name << YAML::Value << fmt::format("{}", value);
  yaml << YAML::Key << "rostopic" << YAML::Value << "/" + imu.name << YAML::Key << "time_offset"
       << YAML::Value << "0.0" << YAML::Key << "update_rate" << YAML::Value << fmt::format("{}", imu.rate)
       << YAML::Key << "model" << YAML::Value << "kalibr";
  addRows(yaml, "Tw", Tw);
  addRows(yaml, "R_IMUtoGYRO", R);
  addRows(yaml, "Ta", Ta);
  addRows(yaml, "R_IMUtoACC", I);
  addRows(yaml, "Tg", square(model.gyro_by_force));
  yaml << YAML::EndMap << YAML::EndMap;
  return fileText(yaml);
}

}  // namespace slom::app::calib
