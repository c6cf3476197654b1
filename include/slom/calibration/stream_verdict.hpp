/// Verdict on the result of IMUs in motion: whether it can be trusted.
#pragma once

#include <optional>

#include "slom/calibration/assess.hpp"
#include "slom/calibration/imu_stream.hpp"
#include "slom/calibration/stream_agreement.hpp"

namespace slom::calibration {

/// Returns the verdict on IMUs in motion. It is
///   failed        the fit did not converge, or the data leave a direction open
///   doubtful      images and readings contradict each other, residuals are 1.5 times as large as the given noise predicts,
///                 the noise is 10 times that of a usual sensor, a sensor is saturated, a pose is known to 1 cm or
///                 0.5 degrees only or a clock to 1 ms only, images of cameras seem to have wrong times or rows that are
///                 read one after the other, the clock of an IMU drifts, estimated scales and axes of an IMU move its pose or clock
///                 far, its accelerometer lags behind its gyroscope, the halves of the recording disagree, or `agreement` has a contradiction
///   trustworthy   otherwise
/// `cameras`: their result, with its assessment if there is one (Result::quality).
Verdict verdictOf(const StreamResult& streams, const Result& cameras,
                  const std::optional<StreamAgreement>& agreement = {});

}  // namespace slom::calibration
