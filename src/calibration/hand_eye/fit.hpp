// The fit of hand and eye to rows or motions.
#pragma once

#include <optional>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/hand_eye/streams.hpp"
#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// Standard deviation of each component of a residual.
struct HandEyeNoise {
  double rotation_rad = 0, translation_m = 0;
};

/// Lengths of the residuals of a row or a motion.
struct Misfit {
  double rotation_rad = 0, translation_m = 0;
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

/// The problem: X, Y, shift and scale, with two measurements for each item.
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

/// Returns the residuals of all items, 6 for each: rotation [rad], then translation [m].
Eigen::VectorXd residualsAt(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                            const HandEyeValues& values);
/// Returns their lengths.
std::vector<Misfit> misfitsOf(const Eigen::VectorXd& residuals);

}  // namespace slom::calibration
