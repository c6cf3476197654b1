/// FieldCheck: detects, by the turns of the magnetic field in the body, rates in degrees per second, and axes of the
/// magnetometer that differ from the axes of the gyroscope.
///
/// A part of a run ends when the field has turned by 0.15 rad, or after 10 s. The turn of the field is compared with
/// the angular velocities as given, and with 7 faults: rates in degrees per second, one axis of the magnetometer
/// reversed (3), or two axes swapped (3). A fault is the verdict after 15 parts that it explains and the readings as
/// given do not, if these are more than half of all parts, and the contrary happened less than an eighth as often. No
/// fault explains a field that does not turn with the body, such as the field of a magnet on the body. The check ends
/// after 8 contrary votes against each fault, or after 1000 parts. Turns about a single axis cannot show that this
/// axis is reversed; this does no harm then, because only the dip has the other sign. A field with all axes reversed
/// turns like the right one.
#pragma once

#include "mtk/types/so3.hpp"
#include "slom/filter/arguments.hpp"
#include "slom/filter/models/angle_between.hpp"
#include "slom/filter/status.hpp"

namespace slom::detail {

template <class S>
class FieldCheck {
 public:
  using Vector = mtk::vect<3, S>;

  /// Takes the readings of one step. Returns field_axes_differ, rate_in_degrees or done. A verdict is final.
  FilterStatus take(const Vector& gyro, const Vector& field, const S& dt) {
    if (is_over_ || verdict_ != FilterStatus::done || !isFiniteArgument(field)) return verdict_;
    const bool begins = !(time_ > S(0));
    if (!begins) {
      const Vector turn(gyro * dt);
      by_radians_ = by_radians_ * mtk::SO3<S>::exp(turn);
      by_degrees_ = by_degrees_ * mtk::SO3<S>::exp(Vector(turn * degree<S>));
      const S moved = angleBetween<S>(first_, field);
      const bool has_turned = moved > S(0.15);
      if (has_turned) vote(field, moved);
      if (has_turned || time_ > S(10)) time_ = S(0);
    }
    if (!(time_ > S(0))) {
      first_ = field;
      by_radians_ = by_degrees_ = mtk::SO3<S>();
    }
    time_ += dt;
    return verdict_;
  }
  /// Ends the check.
  void stop() {
    is_over_ = true;
    verdict_ = FilterStatus::done;
  }

 private:
  static constexpr int kReversed = 3, kDegrees = 6, kOthers = 7;

  /// Returns the field with an axis reversed (k < 3), two swapped, or as it is (kDegrees).
  static Vector changed(const Vector& v, int k) {
    Vector w = v;
    if (k < kReversed) {
      w[k] = -v[k];
    } else if (k < kDegrees) {
      const int i = k - kReversed, j = (i + 1) % 3;
      w[i] = v[j];
      w[j] = v[i];
    }
    return w;
  }
  void vote(const Vector& field, const S& moved) {
    const S off = angleBetween<S>(by_radians_.inverse() * first_, field);
    is_over_ = ++parts_ >= 1000;
    bool is_right = true;
    for (int k = 0; k < kOthers; ++k) {
      const mtk::SO3<S>& turned = k == kDegrees ? by_degrees_ : by_radians_;
      const S off_other = angleBetween<S>(turned.inverse() * changed(first_, k), changed(field, k));
      votes_[k] += off_other < moved / S(3) && off > moved / S(2) && off > S(4) * off_other;
      contrary_[k] += off < moved / S(3) && off_other > moved / S(2) && off_other > S(4) * off;
      if (votes_[k] >= 15 && votes_[k] > 8 * contrary_[k] && 2 * votes_[k] > parts_)
        verdict_ = k == kDegrees ? FilterStatus::rate_in_degrees : FilterStatus::field_axes_differ;
      is_right = is_right && contrary_[k] >= 8 && contrary_[k] > votes_[k];
    }
    is_over_ = is_over_ || is_right;
  }

  FilterStatus verdict_ = FilterStatus::done;
  bool is_over_ = false;
  S time_ = S(0);                        // of a part [s]
  Vector first_;                         // field at the begin of a part
  mtk::SO3<S> by_radians_, by_degrees_;  // turn of a part, by the unit of the rates
  int parts_ = 0;                        // with a turn of the field
  int votes_[kOthers] = {};              // parts that this change explains and the readings as given do not
  int contrary_[kOthers] = {};           // parts that the readings as given explain and this change does not
};

}  // namespace slom::detail
