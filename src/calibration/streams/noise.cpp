// The noise of corners and readings, from what the fit leaves of their residuals.
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {
namespace {

/// Returns v^T C^-1 v.
template <int N>
double squaredIn(const Eigen::Matrix<double, N, N>& C, const Eigen::Matrix<double, N, 1>& v) {
  return v.dot(C.llt().solve(v));
}

}  // namespace

double limited(double ratio) { return std::isfinite(ratio) ? std::clamp(ratio, 0.1, 10.) : 1; }

/// Returns what a fit leaves of the residuals of a typical interval: the expected squares of the rotation, and of velocity
/// and position, each whitened.
std::pair<double, double> StreamProblem::expectedSquares(const Imu& imu) const {
  constexpr std::size_t most = 200;  // intervals, spread evenly
  double gyro = 0, force = 0, count = 0;
  est_.marginals();  // the inverse by blocks, from which joint covariances are read
  const std::size_t step = std::max<std::size_t>(1, imu.intervals.size() / most);
  for (std::size_t k = step / 2; k < imu.intervals.size(); k += step) {
    const Interval& one = imu.intervals[k];
    const std::size_t i = one.first;
    const PreintegratedImu::Covariance9 absorbed = imu.axes.with([&](const auto&... axes) {
      const auto predicted =
          est_.propagate(ImuBetweenImages(imu.samples, images_[i].time, images_[i + 1].time, gravity_),
                         left2world_.at(images_[i].image), imu.velocities[i], imu.gyro_biases[k],
                         imu.force_biases[k], left2world_.at(images_[i + 1].image), imu.velocities[i + 1],
                         imu.left2imu, imu.offset, up_, board_scale_, axes...);
      return PreintegratedImu::Covariance9(predicted.covariance);
    });
    gyro += 3 - one.turnNoise().llt().solve(absorbed.topLeftCorner<3, 3>()).trace();
    force += 6 - one.pushNoise().llt().solve(absorbed.bottomRightCorner<6, 6>()).trace();
    ++count;
  }
  return {gyro / count, force / count};
}

StreamProblem::Ratios StreamProblem::ratiosOf(const Imu& imu) const {
  double gyro = 0, force = 0;
  for (const Interval& one : imu.intervals) {
    const Eigen::Matrix<double, 9, 1> r = est_.residual(one.id);
    gyro += squaredIn<3>(one.turnNoise(), r.head<3>()) / double(imu.intervals.size());
    force += squaredIn<6>(one.pushNoise(), r.tail<6>()) / double(imu.intervals.size());
  }
  const auto [gyro_expected, force_expected] = expectedSquares(imu);
  return {std::sqrt(gyro / gyro_expected), std::sqrt(force / force_expected)};
}

double StreamProblem::timeBetween(const Imu& imu, std::size_t k) const {
  const Interval &a = imu.intervals[k - 1], &b = imu.intervals[k];
  return images_[b.first].time + b.duration / 2 - images_[a.first].time - a.duration / 2;
}

double StreamProblem::imageRatio() const {
  double squares = 0, expected = 0;
  est_.marginals();  // the inverse by blocks, from which joint covariances are read
  for (const auto& [image, seen] : seen_) {
    if (seen.R.rows() < 6) continue;
    const Eigen::MatrixXd by_variables = seen.R.leftCols<6>().transpose() * seen.R;
    const Eigen::Matrix<double, 6, 6> H = by_variables.leftCols<6>();
    const Eigen::Matrix<double, 6, 1> gradient = seen.R.leftCols<6>().transpose() * est_.residual(seen.id);
    const Eigen::Matrix<double, 6, 6> absorbed =
        by_variables * est_.jointCovariance(seen.variables) * by_variables.transpose();
    squares += squaredIn<6>(H, gradient);
    expected += 6 - H.llt().solve(absorbed).trace();
  }
  return std::sqrt(squares / expected);
}

}  // namespace slom::calibration
