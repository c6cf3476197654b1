/// UnitCheck: detects readings of an IMU in g or degrees per second instead of m/s^2 and rad/s.
///
///   force  in the first 100 readings, at least 1 s: more than half have a length of 0.7 to 1.3, as in g, instead of 9.81, and
///          so has their mean in a frame that does not turn. Free fall, vibration and strong motion have not; a fall that is
///          braked to 0.07 to 0.13 g for the whole time has.
///   rate   parts of 0.5 s: angular velocities in degrees explain how the specific force turns in the body, and those in
///          radians do not, at least 8 times and 4 times as often as the contrary. Or 10 readings in a row are above 80
///          rad/s, beyond the range of MEMS gyroscopes.
/// Turns about the vertical give no evidence (field_check.hpp uses a magnetometer), and rest gives no evidence on
/// rates. With free fall, strong accelerations, wrong axes or an accelerometer whose readings stand still, neither
/// unit explains the readings, so there is no verdict. The check of rates ends when radians explain 8 parts.
#pragma once

#include <cmath>

#include "mtk/types/so3.hpp"
#include "slom/filter/arguments.hpp"
#include "slom/filter/models/angle_between.hpp"
#include "slom/filter/status.hpp"

namespace slom::detail {

template <class S>
class UnitCheck {
 public:
  using Vector = mtk::vect<3, S>;

  /// Takes the readings of one step, gravity [m/s^2]. Returns force_in_g, rate_in_degrees or done. A verdict is final.
  FilterStatus take(const Vector& gyro, const Vector& force, const S& dt, const S& gravity) {
    if (verdict_ != FilterStatus::done || !(dt > S(0)) || !isFiniteArgument(gyro) || !isFiniteArgument(force))
      return verdict_;
    if (!knows_force_) takeForce(gyro, Vector(force * (S(9.81) / gravity)), dt);
    if (!knows_rate_) takeRate(gyro, force, dt);
    return verdict_;
  }
  /// Ends the check.
  void stop() {
    verdict_ = FilterStatus::done;
    knows_force_ = knows_rate_ = true;
  }

 private:
  void takeForce(const Vector& gyro, const Vector& force, const S& dt) {
    const auto isOne = [](const Vector& f) { return f.norm() > S(0.7) && f.norm() < S(1.3); };
    ++readings_;
    time_ += dt;
    in_g_ += isOne(force);
    turned_ = turned_ * mtk::SO3<S>::exp(Vector(gyro * dt));
    sum_ += turned_ * force;
    if (readings_ < 100 || time_ < S(1)) return;
    knows_force_ = true;
    if (2 * in_g_ > readings_ && isOne(Vector(sum_ / S(readings_)))) verdict_ = FilterStatus::force_in_g;
  }
  void takeRate(const Vector& gyro, const Vector& force, const S& dt) {
    too_fast_ = gyro.squaredNorm() > S(80 * 80) ? too_fast_ + 1 : 0;
    if (too_fast_ >= 10) verdict_ = FilterStatus::rate_in_degrees;
    if (part_ > S(0)) {
      const Vector turn(gyro * dt);
      angle_ += turn.norm();
      by_radians_ = by_radians_ * mtk::SO3<S>::exp(turn);
      by_degrees_ = by_degrees_ * mtk::SO3<S>::exp(Vector(turn * degree<S>));
    }
    part_ += dt;
    if (part_ > S(0.5)) {
      if (angle_ > S(0.5)) vote(force);
      part_ = S(0);
    }
    if (part_ == S(0) || part_ == dt) {  // the first reading of a part
      part_ = dt;
      angle_ = S(0);
      first_force_ = force;
      by_radians_ = by_degrees_ = mtk::SO3<S>();
    }
  }
  void vote(const Vector& force) {
    const S moved = angleBetween<S>(first_force_, force);
    const S off_radians = angleBetween<S>(by_radians_.inverse() * first_force_, force);
    const S off_degrees = angleBetween<S>(by_degrees_.inverse() * first_force_, force);
    if (moved < S(0.05)) return;  // turns about the vertical, or an accelerometer that hangs
    radians_ += off_radians < moved / S(2);
    degrees_ += off_degrees < moved / S(2) && off_radians > S(0.5) && off_radians > S(3) * off_degrees;
    knows_rate_ = radians_ >= 8 && radians_ > degrees_;
    if (degrees_ >= 8 && degrees_ > 4 * radians_) verdict_ = FilterStatus::rate_in_degrees;
  }

  FilterStatus verdict_ = FilterStatus::done;
  bool knows_force_ = false, knows_rate_ = false;
  int readings_ = 0, in_g_ = 0;
  mtk::SO3<S> turned_;                   // since the first reading
  Vector sum_;                           // of forces, in the axes of the first reading
  S time_ = S(0);                        // of the readings of forces [s]
  int too_fast_ = 0;                     // in a row
  S part_ = S(0), angle_ = S(0);         // of a part: duration [s], sum of turns [rad]
  Vector first_force_;                   // of a part
  mtk::SO3<S> by_radians_, by_degrees_;  // turn of a part, by the unit of the rates
  int radians_ = 0, degrees_ = 0;        // parts that this unit explains
};

}  // namespace slom::detail
