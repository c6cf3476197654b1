/// Attitude from gyroscope, accelerometer and magnetometer (AHRS).
///
///     slom::filter::AttitudeFilter<> filter;
///     for (const auto& r : readings) filter.step(r.gyro, r.force, r.field, dt);
///     filter.orientation();                                    // world_R_body
///
///   world   x east, y magnetic north, z up
///   body    the axes of the sensors; at rest the accelerometer reads +g upwards
/// The specific force is integrated to a velocity that stays near 0 on average: v ~ (0, sigma^2) with a short memory.
/// So gravity is separated from motion by an assumption on the motion instead of a threshold on accelerations. The
/// field of the earth has an unknown horizontal and vertical part that drift slowly, so dip and strength need not be
/// known. Readings of the field that differ from it in these two parts are disturbed, and count less.
#pragma once

#include <cmath>

#include "mtk/types/so3.hpp"
#include "slom/filter/error_state_filter.hpp"
#include "slom/filter/models/field_check.hpp"
#include "slom/filter/models/unit_check.hpp"

namespace slom::filter {

/// The state: 11 degrees of freedom.
template <class S = double>
struct AttitudeState {
  mtk::SO3<S> orient;           ///< world_R_body
  mtk::vect<3, S> gyro_bias;    ///< [rad/s]
  mtk::vect<3, S> velocity;     ///< in the world [m/s]
  mtk::vect<2, S> earth_field;  ///< its parts along north and up [unit of the magnetometer]
};

/// Noise by the physics of small MEMS sensors that are moved by hand, on a robot or a vehicle.
/// docs/filter_models.md has the reasons for each number.
template <class S = double>
struct AttitudeNoise {
  S gyro = S(2e-4);            ///< white noise [rad/s/sqrt(Hz)]
  S gyro_scale = S(3e-3);      ///< error per angular velocity, of scale and axes, [rad / (rad/s) / sqrt(s)]
  S gyro_walk = S(2e-5);       ///< of the bias [rad/s/sqrt(s)]
  S force = S(2e-2);           ///< white noise and rounding [m/s^2/sqrt(Hz)]
  S velocity = S(0.5);         ///< standard deviation of the body's velocity [m/s]
  S velocity_memory = S(0.3);  ///< its correlation time [s]
  S field = S(0.02);           ///< of one reading's disturbance, divided by the strength of the field [1]
  S field_memory = S(1);       ///< its correlation time [s]
  S field_walk = S(1e-2);      ///< of the earth's field, divided by its strength [1/sqrt(s)]
  S disturbed = S(0.12);       ///< a field off by this part of the strength has a quarter of the weight [1]
  S start_tilt = S(0.05);      ///< standard deviations at the start: tilt and heading [rad]
  S start_bias = S(0.01);      ///< of the gyroscope [rad/s]
  S gravity = S(9.81);         ///< [m/s^2]
};

/// The motion between two readings: the mean readings turn and accelerate the body for dt [s].
struct AttitudeMotion {
  template <class State, class T>
  State operator()(const State& x, const mtk::vect<3, T>& gyro, const mtk::vect<3, T>& force,
                   const T& gravity, const T& dt) const {
    using S = mtk::scalar_t<State>;
    const mtk::vect<3, S> half((gyro - x.gyro_bias) * (dt / T(2)));
    const mtk::SO3<S> half_turn = mtk::SO3<S>::exp(half);
    const mtk::SO3<S> middle = x.orient * half_turn;
    State y = x;
    y.orient = middle * half_turn;
    y.velocity =
        x.velocity + (middle * mtk::vect<3, S>(force) - mtk::vect<3, S>(S(0), S(0), S(gravity))) * dt;
    return y;
  }
};

/// Residual of a magnetometer, in the world: world_R_body m - (0, north, up).
struct EarthField {
  template <class State, class T>
  auto operator()(const State& x, const mtk::vect<3, T>& field) const {
    using S = mtk::scalar_t<State>;
    return mtk::vect<3, S>(x.orient * mtk::vect<3, S>(field) -
                           mtk::vect<3, S>(S(0), x.earth_field[0], x.earth_field[1]));
  }
};

/// Returns the orientation whose world has this specific force upwards and this field towards north; `good` is false if
/// they are 0 or parallel.
///   source  Shuster and Oh, "Three-axis attitude determination from vector observations", 1981 (TRIAD)
template <class S>
mtk::SO3<S> orientationFrom(const mtk::vect<3, S>& force, const mtk::vect<3, S>& field, bool& good) {
  const auto cross = [](const mtk::vect<3, S>& a, const mtk::vect<3, S>& b) {
    return mtk::vect<3, S>(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  };
  const mtk::vect<3, S> east = cross(field, force), north = cross(force, east);
  const S e = east.norm(), n = north.norm(), u = force.norm();
  good = e > S(1e-3) * field.norm() * u && n > S(0) && e - e == S(0) && n - n == S(0);
  if (!good) return {};
  Eigen::Matrix<S, 3, 3, Eigen::DontAlign> R;
  for (int j = 0; j < 3; ++j) {
    R(0, j) = east[j] / e;
    R(1, j) = north[j] / n;
    R(2, j) = force[j] / u;
  }
  return mtk::SO3<S>(R);
}

/// The filter with its steps in order.
template <class S = double, template <class, int> class Form = FullCovariance>
class AttitudeFilter {
 public:
  using State = AttitudeState<S>;
  using Filter = ErrorStateFilter<State, Form>;

  /// Creates a filter that waits for its first readings, with the usual noise.
  AttitudeFilter() = default;
  /// Creates a filter with other noise.
  explicit AttitudeFilter(const AttitudeNoise<S>& noise) : noise_(noise) {}

  /// Takes one set of readings: angular velocity [rad/s], specific force [m/s^2], field (any unit), in the axes of the
  /// body, `dt` [s] after the last one. The first call sets the orientation. Returns the status of the first step that
  /// was refused; done otherwise. A refused magnetometer leaves the prediction in place. All steps are refused from the
  /// moment at which the readings look like g (force_in_g) or degrees per second (rate_in_degrees), or the axes of the
  /// magnetometer differ from those of the gyroscope (field_axes_differ). unit_check.hpp and field_check.hpp have the rules.
  FilterStatus step(const mtk::vect<3, S>& gyro, const mtk::vect<3, S>& force, const mtk::vect<3, S>& field,
                    const S& dt) {
    const FilterStatus checked = check(gyro, force, &field, dt);
    if (checked != FilterStatus::done) return checked;
    if (!has_field_) return start(force, field);
    const FilterStatus predicted = predict(gyro, force, dt);
    if (predicted != FilterStatus::done) return predicted;
    if (!(field.squaredNorm() > S(0))) {
      return slom::detail::isFiniteArgument(field) ? FilterStatus::no_heading : FilterStatus::data_not_finite;
    }
    using std::sqrt;
    const mtk::vect<3, S> seen = EarthField()(filter_.state(), field);
    const S off = (square(seen[1]) + square(seen[2])) / square(noise_.disturbed * strength_);
    const S sigma = noise_.field * strength_ * sqrt(S(2) * noise_.field_memory / dt) * (S(1) + off);
    return filter_.update(EarthField(), field, StandardDeviation(sigma)).status;
  }
  /// Takes readings without a magnetometer. If they are the first ones, they set the tilt, and the heading begins at 0. The
  /// first field after them sets the orientation anew.
  FilterStatus step(const mtk::vect<3, S>& gyro, const mtk::vect<3, S>& force, const S& dt) {
    const FilterStatus checked = check(gyro, force, nullptr, dt);
    if (checked != FilterStatus::done) return checked;
    return is_started_ ? predict(gyro, force, dt) : start(force);
  }

  /// Ends the checks of units and axes. Call it if the body begins with a motion that looks like another unit.
  void trustUnits() {
    units_.stop();
    field_.stop();
  }
  /// Returns world_R_body.
  const mtk::SO3<S>& orientation() const { return filter_.state().orient; }
  /// Returns the error-state filter.
  const Filter& filter() const { return filter_; }
  /// Returns whether readings have set the orientation.
  bool isStarted() const { return is_started_; }

 private:
  static S square(const S& x) { return x * x; }
  FilterStatus check(const mtk::vect<3, S>& gyro, const mtk::vect<3, S>& force, const mtk::vect<3, S>* field,
                     const S& dt) {
    if (!(dt > S(0)) || !slom::detail::isFinite(dt)) return FilterStatus::bad_duration;
    if (!slom::detail::isFiniteArgument(gyro) || !slom::detail::isFiniteArgument(force))
      return FilterStatus::data_not_finite;
    const FilterStatus units = units_.take(gyro, force, dt, noise_.gravity);
    if (units != FilterStatus::done || field == nullptr) return units;
    return field_.take(gyro, *field, dt);
  }
  FilterStatus predict(const mtk::vect<3, S>& gyro, const mtk::vect<3, S>& force, const S& dt) {
    using std::sqrt;
    const S turn = square(noise_.gyro) + square(noise_.gyro_scale) * gyro.squaredNorm();
    mtk::vect<11, S> variances;
    for (int i = 0; i < 3; ++i) {
      variances[i] = turn * dt;
      variances[3 + i] = square(noise_.gyro_walk) * dt;
      variances[6 + i] = square(noise_.force) * dt;
    }
    variances[9] = variances[10] = square(noise_.field_walk * strength_) * dt;
    const PredictionResult predicted =
        filter_.predict(AttitudeMotion(), Covariance(variances), gyro, force, noise_.gravity, dt);
    if (!predicted) return predicted.status;
    const S sigma = noise_.velocity * sqrt(S(2) * noise_.velocity_memory / dt);
    return filter_.update([](const auto& x) { return x.velocity; }, StandardDeviation(sigma)).status;
  }
  static mtk::vect<11, S> startDeviations(const AttitudeNoise<S>& noise, const S& strength) {
    mtk::vect<11, S> sigma;
    for (int i = 0; i < 3; ++i) {
      sigma[i] = noise.start_tilt;
      sigma[3 + i] = noise.start_bias;
      sigma[6 + i] = noise.velocity;
    }
    sigma[9] = sigma[10] = noise.field * strength * S(2);
    return sigma;
  }
  FilterStatus start(const mtk::vect<3, S>& force, const mtk::vect<3, S>& field) {
    if (!slom::detail::isFiniteArgument(field)) return FilterStatus::data_not_finite;
    if (!(force.squaredNorm() > S(0))) return FilterStatus::no_tilt;
    bool good = false;
    State x;
    x.orient = orientationFrom(force, field, good);
    if (!good) return FilterStatus::no_heading;
    strength_ = field.norm();
    const mtk::vect<3, S> in_world = x.orient * field;
    x.earth_field = mtk::vect<2, S>(in_world[1], in_world[2]);
    const FilterStatus status = filter_.reset(x, StandardDeviation(startDeviations(noise_, strength_)));
    is_started_ = has_field_ = status == FilterStatus::done;
    return status;
  }
  FilterStatus start(const mtk::vect<3, S>& force) {
    // Any field will do that is not parallel to the force: it sets the heading.
    using std::abs;
    mtk::vect<3, S> forward(S(0), S(1), S(0));
    if (abs(force[1]) > S(0.9) * force.norm()) forward = mtk::vect<3, S>(S(0), S(0), S(1));
    bool good = false;
    State x;
    x.orient = orientationFrom(force, forward, good);
    if (!good) return FilterStatus::no_tilt;
    const FilterStatus status = filter_.reset(x, StandardDeviation(startDeviations(noise_, S(1))));
    is_started_ = status == FilterStatus::done;
    return status;
  }

  AttitudeNoise<S> noise_;
  S strength_ = S(1);
  bool is_started_ = false, has_field_ = false;
  slom::detail::UnitCheck<S> units_;
  slom::detail::FieldCheck<S> field_;
  Filter filter_{State{}, StandardDeviation(startDeviations(AttitudeNoise<S>(), S(1)))};
};

}  // namespace slom::filter
