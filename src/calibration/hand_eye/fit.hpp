// The fit of hand and eye to rows or motions.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/hand_eye/streams.hpp"
#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// The covariance of a residual: translation [unit of the camera's stream], rotation [rad], along the axes of the camera.
struct HandEyeNoise {
  using Matrix = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;
  Matrix covariance = Matrix::Identity();

  /// Returns the root mean square standard deviation of a component.
  double translation() const { return std::sqrt(covariance.diagonal().head<3>().mean()); }
  double rotation_rad() const { return std::sqrt(covariance.diagonal().tail<3>().mean()); }
};

/// A motion that does not change the residuals, or not beyond noise, by components: X (translation [m], rotation
/// [rad]), shift [s], scale. A unit vector in units of `unit`.
using Direction = Eigen::Matrix<double, 8, 1, Eigen::DontAlign>;
struct Held {
  std::vector<Direction> directions;
  Direction unit = Direction::Ones();
};

/// Rows, or pairs of rows, to be fitted.
using Items = std::vector<RowPair>;

/// The problem: X, Y, shift and scale, with a measurement for each item.
class HandEyeProblem {
 public:
  HandEyeProblem(const Streams& streams, const HandEyeSettings& settings, const HandEyeValues& start,
                 const HandEyeNoise& noise);

  /// Adds rows or motions; errors within `block_s` seconds may depend on each other.
  void insert(const Items& items, const Loss& loss, double block_s);
  /// Keeps the values from moving along these directions.
  void hold(const Held& held);

  Summary optimize();
  HandEyeValues values() const;
  Estimator& estimator() { return est_; }

  VarID<SE3> X, Y;
  VarID<mtk::Scalar<>> shift, scale;

 private:
  template <bool kInterpolatesHand>
  void insertItem(const RowPair& item, const Loss& loss, std::int64_t block);

  const Streams& streams_;
  const HandEyeSettings& settings_;
  HandEyeNoise noise_;
  Estimator est_;
};

/// A residual: translation [unit of the camera's stream], rotation [rad].
using Residual = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;
/// Returns the residuals of all items.
std::vector<Residual> residualsAt(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                                  const HandEyeValues& values);

}  // namespace slom::calibration
