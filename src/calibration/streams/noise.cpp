// The noise of corners and readings, from what the fit leaves of their residuals.
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calibration/fit/seen_board.hpp"
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
  constexpr std::size_t most =
      24;  // intervals, spread evenly; each needs the joint covariance of its variables
  double gyro = 0, force = 0, count = 0;
  const std::size_t step = std::max<std::size_t>(1, imu.intervals.size() / most);
  for (std::size_t k = step / 2; k < imu.intervals.size(); k += step) {
    const Interval& one = imu.intervals[k];
    const std::size_t i = one.first;
    const auto predicted = est_.propagate(
        ImuBetweenImages(imu.samples, images_[i].time, images_[i + 1].time, gravity_),
        rig_.poses().at(images_[i].image), imu.velocities[i], imu.gyro_biases[k], imu.force_biases[k],
        rig_.poses().at(images_[i + 1].image), imu.velocities[i + 1], imu.left2imu, imu.offset, up_);
    const PreintegratedImu::Covariance9 absorbed = predicted.covariance;
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

double StreamProblem::imageRatio() const {
  constexpr std::size_t most =
      24;  // images, spread evenly, that need the joint covariance of their variables
  const std::size_t step = std::max<std::size_t>(1, images_.size() / most);
  const CamerasStart now = cameras();
  double squares = 0, expected = 0, count = 0;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const PullOfImage image = pullOf(images_[i].image, now);
    const Eigen::Matrix<double, 6, 6> H = image.by_variables.leftCols<6>();
    squares += squaredIn<6>(H, image.gradient) / double(images_.size());
    if (i % step != step / 2) continue;
    std::vector<AnyVarID> variables{rig_.poses().at(images_[i].image)};
    for (const auto& lens : rig_.lenses()) variables.push_back(lens);
    for (const auto& pose : rig_.camerasOnRig()) variables.push_back(pose);
    const Eigen::Matrix<double, 6, 6> absorbed =
        image.by_variables * est_.jointCovariance(variables) * image.by_variables.transpose();
    expected += 6 - H.llt().solve(absorbed).trace();
    ++count;
  }
  return std::sqrt(squares / (expected / count));
}

/// Adds up the corners of an image.
StreamProblem::PullOfImage StreamProblem::pullOf(int image, const CamerasStart& now) const {
  const auto& [lenses, rig] = now;
  Eigen::Index columns = 6 * Eigen::Index(lenses.size());
  for (const Lens& lens : lenses) columns += lens.parameters();
  PullOfImage pull{Eigen::MatrixXd::Zero(6, columns), Eigen::Matrix<double, 6, 1>::Zero()};
  Eigen::Index by_lens = 6, by_camera = columns - 6 * Eigen::Index(lenses.size() - 1);
  for (std::size_t c = 0; c < lenses.size(); ++c) {
    if (const View* const view = data_.cameras[c].find(image)) {
      const SeenBoard board(lenses[c], rig.left2camera[c], rig.left2world.at(image));
      for (const Corner& corner : view->corners) {
        const SeenBoard::Rows rows = board.rowsOf(corner.world);
        const double weight = 1 / std::pow(settings_.sigma_px * corner.sigma, 2);
        const Eigen::Matrix<double, 6, 2> weighted = weight * rows.byLeft2World().transpose();
        pull.gradient += weighted * (rows.pixel() - corner.pixel);
        pull.by_variables.leftCols<6>() += weighted * rows.byLeft2World();
        pull.by_variables.middleCols(by_lens, lenses[c].parameters()) += weighted * rows.seen.by_parameters;
        if (c > 0) pull.by_variables.middleCols<6>(by_camera) += weighted * rows.byLeft2Camera();
      }
    }
    by_lens += lenses[c].parameters();
    if (c > 0) by_camera += 6;
  }
  return pull;
}

}  // namespace slom::calibration
