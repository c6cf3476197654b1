#include "calibration/streams/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slom::calibration {
namespace {

/// The axes of a 3 x 3 covariance: standard deviations in rising order, and the direction of the largest.
struct Axes {
  explicit Axes(const Eigen::Matrix3d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
    std = axes.eigenvalues().cwiseMax(0).cwiseSqrt();
    worst = axes.eigenvectors().col(2);
    if (worst.sum() < 0) worst = -worst;
  }
  std::string direction() const {
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", worst[0], worst[1], worst[2]);
  }

  Eigen::Vector3d std, worst;
};

constexpr double in_degrees = 180 / std::numbers::pi;

/// Names of the errors of axes, in the order of ImuAxesResult::std, with the largest usual standard deviation, and the
/// motion that determines them.
struct AxisError {
  std::string name;
  double most;
  const char* unit;
  double per_unit;
  std::string motion;
};
std::vector<AxisError> axisErrors() {
  constexpr double most_scale = 0.02, most_by_force = 0.002, most_place = 0.02;  // m for the last
  const char axes[] = "xyz";
  std::vector<AxisError> all;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column)
      all.push_back(
          {fmt::format("accelerometer's {}{}", axes[row], axes[column]), most_scale, "%", 100,
           fmt::format("hold the rig so that gravity acts along {0} and against {0}", axes[column])});
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      all.push_back({fmt::format("gyroscope's {}{}", axes[row], axes[column]), most_scale, "%", 100,
                     fmt::format("turn about {} quickly", axes[column])});
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      all.push_back(
          {fmt::format("gyroscope's sensitivity {} to forces along {}", axes[row], axes[column]),
           most_by_force, "rad/s/(m/s^2)", 1,
           fmt::format("hold the rig so that gravity acts along {0} and against {0}", axes[column])});
  }
  for (const char sensor : {'y', 'z'}) {
    for (const char axis : {'x', 'y', 'z'})
      all.push_back({fmt::format("place of the accelerometer for {} along {}", sensor, axis), most_place,
                     "mm", 1000, "turn about all axes quickly"});
  }
  return all;
}

void addUncertainAxes(const ImuStreamResult& fitted, std::vector<std::string>& sentences) {
  const std::vector<AxisError> errors = axisErrors();
  std::vector<std::string> open, motions;
  for (std::size_t i = 0; i < fitted.axes.std.size(); ++i) {
    const double std = fitted.axes.std[i];
    if (!(std > errors[i].most)) continue;
    open.push_back(
        fmt::format("{} (+- {:.2g} {})", errors[i].name, std * errors[i].per_unit, errors[i].unit));
    if (std::find(motions.begin(), motions.end(), errors[i].motion) == motions.end())
      motions.push_back(errors[i].motion);
  }
  if (open.empty()) return;
  sentences.push_back(fmt::format("{}: the motion hardly determines the {}; {}.", fitted.name,
                                  fmt::join(open, ", the "), fmt::join(motions, "; ")));
}

}  // namespace

ImuExcitation excitationOf(const ImuStream& imu, const std::vector<RigAtImage>& images,
                           const ImuStreamResult& fitted) {
  const double from = images.front().time + fitted.time_offset, to = images.back().time + fitted.time_offset;
  Eigen::Array3d turn = Eigen::Array3d::Zero(), force = turn, square = turn;
  double count = 0;
  for (const ImuSample& sample : imu.samples) {
    if (sample.time < from || sample.time > to) continue;
    turn += (sample.gyro - fitted.gyro_bias).array().square();
    force += sample.force.array();
    square += sample.force.array().square();
    ++count;
  }
  ImuExcitation result;
  if (count == 0) return result;
  result.turns = vec3((turn / count).sqrt().matrix());
  result.forces = vec3((square / count - (force / count).square()).max(0).sqrt().matrix());
  return result;
}

std::vector<std::string> uncertainOf(const ImuStreamResult& fitted, const Eigen::MatrixXd& covariance) {
  constexpr double much_larger = 4;
  std::vector<std::string> sentences;
  const Axes place(covariance.topLeftCorner<3, 3>()), turn(covariance.bottomRightCorner<3, 3>());
  if (place.std[2] > much_larger * place.std[0])
    sentences.push_back(fmt::format(
        "The position of {} is known to {:.2g} mm along {} in its axes, and to {:.2g} mm across; turns about axes "
        "across this direction would determine it better.",
        fitted.name, 1000 * place.std[2], place.direction(), 1000 * place.std[0]));
  if (turn.std[2] > much_larger * turn.std[0])
    sentences.push_back(fmt::format(
        "The orientation of {} is known to {:.2g} deg about {} in the axes of the reference camera, and to {:.2g} deg about "
        "other axes; turns about axes across this direction would determine it better.",
        fitted.name, in_degrees * turn.std[2], turn.direction(), in_degrees * turn.std[0]));
  addUncertainAxes(fitted, sentences);
  return sentences;
}

}  // namespace slom::calibration
