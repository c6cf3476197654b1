#include "calibration/initialization/imu.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "calibration/initialization/right_singular.hpp"
#include "calibration/nearest_rotation.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

struct Rotation {
  SO3 left2imu;
  double misfit;  ///< sum of squared differences [m^2/s^4]
};

/// Returns the best rotation for gravity of a given value, by Kabsch's algorithm.
Rotation kabsch(const std::vector<TiltPair>& pairs, const vec3& bias, double gravity) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const TiltPair& pair : pairs) sum += (pair.acc - bias) * (gravity * pair.up_in_left).transpose();
  Rotation result{SO3(nearestRotation(sum)), 0};
  for (const TiltPair& pair : pairs) {
    result.misfit += (pair.acc - bias - gravity * (result.left2imu * pair.up_in_left)).squaredNorm();
  }
  return result;
}

/// Derivative of the readings by (rotation 3, acc_bias 3, gravity 1) without fixed parameters, and the columns of the
/// others.
struct Sensitivity {
  Eigen::MatrixXd J;
  int bias_at = -1, gravity_at = -1;
};

Sensitivity sensitivity(const std::vector<TiltPair>& pairs, const ImuStart& at, const Fixed& fixed) {
  Sensitivity s;
  int columns = 3;
  if (!fixed.acc_bias) s.bias_at = columns, columns += 3;
  if (!fixed.gravity) s.gravity_at = columns, columns += 1;
  s.J.setZero(3 * Eigen::Index(pairs.size()), columns);
  for (Eigen::Index i = 0; i < Eigen::Index(pairs.size()); ++i) {
    const Eigen::Vector3d up = at.left2imu * pairs[i].up_in_left;
    for (int axis = 0; axis < 3; ++axis) {
      s.J.block<3, 1>(3 * i, axis) = at.gravity * Eigen::Vector3d::Unit(axis).cross(up);
    }
    if (s.bias_at >= 0) s.J.block<3, 3>(3 * i, s.bias_at).setIdentity();
    if (s.gravity_at >= 0) s.J.block<3, 1>(3 * i, s.gravity_at) = up;
  }
  return s;
}

}  // namespace

std::vector<TiltPair> tiltPairs(const ImuData& imu, const std::map<int, SE3>& left2world) {
  std::vector<TiltPair> pairs;
  for (const ImuReading& reading : imu.readings) {
    pairs.push_back({left2world.at(reading.image).orient.inverse() * vec3(0., 0., 1.), reading.acc});
  }
  return pairs;
}

ImuStart startImu(const std::vector<TiltPair>& pairs, const Fixed& fixed, double sigma_acc) {
  ImuStart start;
  if (fixed.acc_bias) start.acc_bias = *fixed.acc_bias;
  double magnitude = 0;
  for (const TiltPair& pair : pairs) magnitude += (pair.acc - start.acc_bias).norm() / double(pairs.size());
  if (fixed.gravity) magnitude = *fixed.gravity;
  const Rotation positive = kabsch(pairs, start.acc_bias, magnitude);
  const Rotation negative = kabsch(pairs, start.acc_bias, -magnitude);
  const bool is_positive = positive.misfit <= negative.misfit;
  start.left2imu = is_positive ? positive.left2imu : negative.left2imu;
  start.gravity = is_positive ? magnitude : -magnitude;
  start.sign_evidence = std::abs(positive.misfit - negative.misfit) / (sigma_acc * sigma_acc);
  return start;
}

ImuPrecision imuPrecision(const std::vector<TiltPair>& pairs, const ImuStart& at, const Fixed& fixed,
                          double sigma_acc) {
  const Sensitivity s = sensitivity(pairs, at, fixed);
  const RightSingular svd = rightSingular(s.J);
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(s.J.cols());
  for (Eigen::Index k = 0; k < s.J.cols(); ++k) {  // zero singular values give infinite variances
    const double value = k < svd.values.size() ? svd.values[k] : 0;
    const bool open = !(value > 1e-12 * svd.values[0]);
    for (Eigen::Index i = 0; i < s.J.cols(); ++i) {
      const double part = std::abs(svd.vectors(i, k));
      if (open && part < 1e-6) continue;
      variance[i] += std::pow(part * sigma_acc / (open ? 0.0 : value), 2);
    }
  }
  const Eigen::VectorXd std = variance.cwiseSqrt();
  return {std.head<3>().maxCoeff(), s.bias_at < 0 ? 0 : std.segment<3>(s.bias_at).maxCoeff(),
          s.gravity_at < 0 ? 0 : std[s.gravity_at]};
}

bool isDetermined(const ImuPrecision& precision) {
  return precision.rotation < 1 && precision.acc_bias < 10 && precision.gravity < 10;
}

double tiltSpread(const std::vector<TiltPair>& pairs) {
  vec3 mean;
  for (const TiltPair& pair : pairs) mean += pair.up_in_left;
  double square = 0;
  for (const TiltPair& pair : pairs) {
    square += std::pow(std::atan2(pair.up_in_left.cross(mean).norm(), pair.up_in_left.dot(mean)), 2);
  }
  return std::sqrt(square / double(pairs.size()));
}

namespace {

/// Returns the root mean square angle between the readings and their mean [rad].
double spreadOfReadings(const std::vector<TiltPair>& pairs) {
  std::vector<TiltPair> directions = pairs;
  for (TiltPair& pair : directions) pair.up_in_left = vec3(pair.acc.normalized());
  return tiltSpread(directions);
}

/// Throws if the readings stay the same although the images show that the rig turned: then the board was moved
/// instead.
void requireReadingsFollow(const ImuData& imu, const std::vector<TiltPair>& pairs) {
  constexpr double least_tilt = 0.05;  // [rad]
  constexpr double hardly = 0.15;      // fraction of the tilts
  const double tilts = tiltSpread(pairs), readings = spreadOfReadings(pairs);
  if (pairs.size() < 3 || !(tilts > least_tilt) || !(readings < hardly * tilts)) return;
  constexpr double degrees = 180 / std::numbers::pi;
  throw DataError(
      "slom.calibration.imu-open",
      {.place = imu.place(0),
       .fault = fmt::format(
           "the readings turn by {:.2g} deg (RMS) from image to image, but by the images the rig turned "
           "by {:.2g} deg against the board",
           readings * degrees, tilts * degrees),
       .remedy = "hold the board still and level, and move the rig"});
}

}  // namespace

void requireImuDetermined(const ImuData& imu, const std::vector<TiltPair>& pairs, const ImuStart& at,
                          const Fixed& fixed, double sigma_acc) {
  requireReadingsFollow(imu, pairs);
  if (isDetermined(imuPrecision(pairs, at, fixed, sigma_acc))) return;
  const auto helps = [&](bool fix_bias, bool fix_gravity) {
    Fixed more = fixed;
    if (fix_bias) more.acc_bias = at.acc_bias;
    if (fix_gravity) more.gravity = std::abs(at.gravity);
    return isDetermined(imuPrecision(pairs, at, more, sigma_acc));
  };
  std::vector<std::vector<std::string>> worth_fixing;
  if (!fixed.gravity && helps(false, true)) worth_fixing.push_back({"gravity"});
  if (!fixed.acc_bias && helps(true, false)) worth_fixing.push_back({"acc_bias"});
  if (worth_fixing.empty() && helps(true, true)) worth_fixing.push_back({"gravity", "acc_bias"});
  std::string what = "the orientation of the IMU";
  if (!fixed.acc_bias) what += ", acc_bias";
  if (!fixed.gravity) what += ", gravity";
  throw DataError(
      "slom.calibration.imu-open",
      {.place = imu.place(0),
       .fault = fmt::format("{} valid reading{} of tilts that spread by {:.2g} deg do not determine {}",
                            pairs.size(), pairs.size() == 1 ? "" : "s",
                            tiltSpread(pairs) * 180 / std::numbers::pi, what),
       .remedy = "add readings at other tilts, about more than one axis",
       .worth_fixing = std::move(worth_fixing)});
}

}  // namespace slom::calibration
