// The file of ROS camera_info, as camera_calibration_parsers reads it.
//   source   https://docs.ros.org/en/rolling/p/sensor_msgs/msg/CameraInfo.html
#include "calibrate/output/formats.hpp"
#include "calibrate/output/yaml_text.hpp"

namespace slom::app::calib {
namespace {

void addMatrix(YAML::Emitter& yaml, const char* key, const Eigen::MatrixXd& matrix) {
  yaml << YAML::Key << key << YAML::Value << YAML::BeginMap << YAML::Key << "rows" << YAML::Value
       << matrix.rows() << YAML::Key << "cols" << YAML::Value << matrix.cols() << YAML::Key << "data"
       << YAML::Value << numbers(matrix.reshaped<Eigen::RowMajor>());
  yaml << YAML::EndMap;
}

}  // namespace

std::string toRosYaml(const CameraResult& camera) {
  const ForeignLens lens = lensFor(OutputFormat::ros, camera);
  const Eigen::Map<const Eigen::RowVectorXd> distortion(lens.distortion.data(),
                                                        Eigen::Index(lens.distortion.size()));
  Eigen::Matrix<double, 3, 4> projection = Eigen::Matrix<double, 3, 4>::Zero();
  projection.leftCols<3>() = camera.camera_matrix;
  YAML::Emitter yaml;
  yaml << YAML::BeginMap << YAML::Key << "image_width" << YAML::Value << camera.image_size->width << YAML::Key
       << "image_height" << YAML::Value << camera.image_size->height << YAML::Key << "camera_name"
       << YAML::Value << camera.name;
  addMatrix(yaml, "camera_matrix", camera.camera_matrix);
  yaml << YAML::Key << "distortion_model" << YAML::Value << lens.distortion_model;
  addMatrix(yaml, "distortion_coefficients", distortion);
  addMatrix(yaml, "rectification_matrix", Eigen::Matrix3d::Identity());
  addMatrix(yaml, "projection_matrix", projection);
  yaml << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace slom::app::calib
