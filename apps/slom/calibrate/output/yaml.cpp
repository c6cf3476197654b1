#include "calibrate/output/yaml.hpp"

#include <fmt/format.h>

namespace slom::app::calib {
namespace {

/// Returns a matrix as `key`, in OpenCV's notation, one row per line.
std::string matrix(const std::string& indent, const std::string& key, const Eigen::MatrixXd& m) {
  std::string text =
      fmt::format("{0}{1}: !!opencv-matrix\n{0}   rows: {2}\n{0}   cols: {3}\n{0}   dt: d\n{0}   data: [",
                  indent, key, m.rows(), m.cols());
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      const bool is_last = i + 1 == m.rows() && j + 1 == m.cols();
      const std::string separator = is_last ? " ]\n" : j + 1 == m.cols() ? ",\n" + indent + "       " : ",";
      text += fmt::format(" {}{}", m(i, j), separator);
    }
  }
  return text;
}

Eigen::RowVectorXd rowOf(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::RowVectorXd>(values.data(), Eigen::Index(values.size()));
}

std::string cameraYaml(const CameraResult& camera, const std::string& reference) {
  const std::string indent(6, ' ');
  std::string text = fmt::format("   {}:\n{}model: \"{}\"\n{}rms_px: {}\n", camera.name, indent, camera.model,
                                 indent, camera.rms_px);
  text += matrix(indent, "camera_matrix", camera.camera_matrix);
  text += matrix(indent, "distortion_coefficients", rowOf(camera.distortion));
  text += matrix(indent, "rotation_from_" + reference, camera.left2camera.orient.toRotationMatrix());
  text += matrix(indent, "translation_from_" + reference, camera.left2camera.pos);
  return text;
}

std::string imuYaml(const ImuResult& imu, const std::string& reference) {
  std::string text = fmt::format("imu:\n   rms_acc: {}\n   gravity: {}\n", imu.rms_acc, imu.gravity);
  text += matrix("   ", "rotation_from_" + reference, imu.left2imu.toRotationMatrix());
  text += matrix("   ", "acc_bias", imu.acc_bias);
  return text;
}

}  // namespace

std::string toOpencvYaml(const Result& result) {
  const std::string& reference = result.cameras.front().name;
  std::string text = fmt::format("%YAML:1.0\n---\nreference: \"{}\"\ncameras:\n", reference);
  for (const CameraResult& camera : result.cameras) text += cameraYaml(camera, reference);
  if (result.imu) text += imuYaml(*result.imu, reference);
  return text;
}

}  // namespace slom::app::calib
