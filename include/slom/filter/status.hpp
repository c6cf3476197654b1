/// FilterStatus: what a step of a filter did, or why it refused. A refused step leaves the filter unchanged.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

enum class [[nodiscard(
    "a refused step leaves the filter unchanged: look at the status")]] FilterStatus : unsigned char{
    done,                   ///< the step was taken
    gated,                  ///< the measurement failed its gate
    data_not_finite,        ///< an argument has NaN or infinity
    bad_duration,           ///< the step in time is not positive and finite
    bad_noise,              ///< the stated noise is not a covariance
    bad_loss,               ///< the scale or the shape of the loss is out of range
    bad_state,              ///< the new state or covariance of a reset is not valid
    function_not_finite,    ///< the function or its derivatives have NaN or infinity
    singular_innovation,    ///< the covariance of the innovation is not positive definite
    covariance_not_finite,  ///< the new covariance has NaN or infinity
    no_mean,                ///< the sigma points have no mean: they spread too far over the manifold
    too_old,                ///< a measurement is older than the history, or newer than the last prediction
    force_in_g,             ///< specific forces look like multiples of g
    rate_in_degrees,        ///< angular velocities look like degrees per second
    field_axes_differ,      ///< the axes of the magnetometer do not turn as those of the gyroscope
    no_heading,             ///< the field is 0 or parallel to the specific force
    no_tilt,                ///< the specific force is 0
};

/// Returns a sentence on the step: what is wrong; what to do.
constexpr const char* toString(FilterStatus status) {
  switch (status) {
    case FilterStatus::done:
      return "the step was taken";
    case FilterStatus::gated:
      return "the innovation lies outside the gate, so the measurement was not used; if this happens often, the stated "
             "noise is too small or the filter has lost the state";
    case FilterStatus::data_not_finite:
      return "an argument has a number that is not finite; leave a measurement out, and predict over the time of a bad motion "
             "reading with the reading before";
    case FilterStatus::bad_duration:
      return "the duration of the prediction, its last argument if none is marked, is not positive and finite; pass the time "
             "since the last prediction in seconds, sort readings by time, and mark a duration that is not last by "
             "slom::Duration(seconds)";
    case FilterStatus::bad_noise:
      return "the stated noise is not a covariance; pass finite numbers: variances of measurements > 0, of motions "
             ">= 0, matrices of the right size, symmetric and without negative eigenvalues";
    case FilterStatus::bad_loss:
      return "the scale of the loss is not positive and finite, or its shape is above 2; pass a scale in standard deviations "
             "of the residual, such as slom::Huber(1.345)";
    case FilterStatus::bad_state:
      return "the state or its covariance is not valid; pass finite numbers and a symmetric covariance without "
             "negative eigenvalues";
    case FilterStatus::function_not_finite:
      return "the function returned a number or derivative that is not finite; check its formula at this state, such "
             "as divisions by 0, and that a motion reads no more noise than slom::noiseArgument states";
    case FilterStatus::singular_innovation:
      return "the covariance of the innovation is not positive definite in floating point; state a larger noise of "
             "the measurement, or use a square-root filter";
    case FilterStatus::covariance_not_finite:
      return "the new covariance is not finite; scale the units of the state so that its variances lie within the "
             "range of the number type";
    case FilterStatus::no_mean:
      return "the sigma points have no mean, because they spread too far over the manifold; use a smaller spread or "
             "shorter steps";
    case FilterStatus::too_old:
      return "the time lies outside the history; predict to the time of a new measurement first, and give the history a "
             "larger capacity for late ones";
    case FilterStatus::force_in_g:
      return "the first specific forces have a length of about 1, as in g; pass m/s^2, which is g times 9.80665, or set the "
             "gravity of the noise to what the accelerometer reads at rest";
    case FilterStatus::rate_in_degrees:
      return "the angular velocities fit the turns of the specific force or the field in degrees per second, or are faster than a MEMS "
             "gyroscope; pass rad/s, which is degrees per second times 0.0174533";
    case FilterStatus::field_axes_differ:
      return "the field turns in the body as if an axis of the magnetometer were reversed or two were swapped; pass the field in "
             "the right-handed axes of the gyroscope";
    case FilterStatus::no_heading:
      return "the field is 0 or parallel to the specific force, so it gives no heading; leave this reading of the "
             "magnetometer out";
    case FilterStatus::no_tilt:
      return "the specific force is 0, so it gives no tilt; begin when the body is not in free fall, and check the "
             "accelerometer";
  }
  return "unknown";
}

/// The result of a prediction. It converts to true if the filter took the step.
struct [[nodiscard(
    "a refused prediction leaves the filter unchanged: look at the result")]] PredictionResult {
  FilterStatus status = FilterStatus::done;
  explicit operator bool() const { return status == FilterStatus::done; }
  /// Returns the sentence of the status.
  const char* message() const { return toString(status); }
};

}  // namespace slom
