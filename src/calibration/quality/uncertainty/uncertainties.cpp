#include "calibration/quality/uncertainty/uncertainties.hpp"

#include <cmath>

#include "calibration/rotation_vector.hpp"

namespace slom::calibration {
namespace {

/// Adds three numbers that follow three shared parameters by J.
void addVector(vec3& stated, vec3& clustered, const Eigen::Matrix3d& J, int first, int shared,
               std::vector<StatedUncertainty>& all) {
  for (int i = 0; i < 3; ++i) {
    Eigen::RowVectorXd by_shared = Eigen::RowVectorXd::Zero(shared);
    by_shared.segment<3>(first) = J.row(i);
    all.push_back({&stated[i], &clustered[i], std::move(by_shared)});
  }
}

void addNumber(double& stated, double& clustered, int column, int shared,
               std::vector<StatedUncertainty>& all) {
  all.push_back({&stated, &clustered, Eigen::RowVectorXd::Unit(shared, column)});
}

}  // namespace

std::vector<StatedUncertainty> uncertaintiesOf(Result& result, const SharedColumns& columns) {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  std::vector<StatedUncertainty> all;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    CameraResult& camera = result.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i)
      addNumber(camera.parameters[i].std, camera.parameters[i].std_clustered, columns.lens[c] + int(i),
                columns.size, all);
    if (c == 0) continue;
    const int pose = columns.pose[c];
    addVector(camera.translation_std, camera.translation_clustered.std, identity, pose, columns.size, all);
    addVector(camera.rotation_std, camera.rotation_clustered.std, identity, pose + 3, columns.size, all);
    addVector(camera.rotation_vector_std, camera.rotation_vector_clustered.std,
              rotationVectorJacobian(camera.left2camera.orient), pose + 3, columns.size, all);
  }
  if (!result.imu) return all;
  ImuResult& imu = *result.imu;
  addVector(imu.rotation_std, imu.rotation_clustered.std, identity, columns.imu, columns.size, all);
  addVector(imu.rotation_vector_std, imu.rotation_vector_clustered.std, rotationVectorJacobian(imu.left2imu),
            columns.imu, columns.size, all);
  addVector(imu.acc_bias_std, imu.acc_bias_clustered.std, identity, columns.imu + 3, columns.size, all);
  addNumber(imu.gravity_std, imu.gravity_std_clustered, columns.imu + 6, columns.size, all);
  return all;
}

void addIndependentError(const Eigen::VectorXd& followed, double std, double std_clustered,
                         const SharedColumns& columns, Result& result) {
  const auto widen = [](double& of, double part) {
    of = of > 0 ? std::hypot(of, part) : of;
  };  // fixed parameters keep 0
  for (const StatedUncertainty& one : uncertaintiesOf(result, columns)) {
    const double by_error = one.by_shared.dot(followed);
    widen(*one.stated, by_error * std);
    widen(*one.clustered, by_error * std_clustered);
  }
  if (result.clustered && !result.clustered->covariance.empty()) {
    const Eigen::Index n = followed.size();
    Eigen::Map<Eigen::MatrixXd> covariance(result.clustered->covariance.data(), n, n);
    const Eigen::VectorXd part = std_clustered * followed;
    if (part.allFinite()) covariance += part * part.transpose();
  }
  if (!result.imu) return;
  ImuResult& imu = *result.imu;
  imu.precision = {imu.rotation_std.maxCoeff(), imu.acc_bias_std.maxCoeff(), imu.gravity_std};
}

}  // namespace slom::calibration
