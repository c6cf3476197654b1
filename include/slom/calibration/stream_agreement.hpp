/// Agreement of two fits of cameras and IMUs in motion, such as a fit by preintegration and a fit by splines.
///
///     StreamSettings other = settings;
///     other.path = StreamPath::splines;
///     const StreamAgreement agreement = agreementOf(calibrateStreams(data, s, cameras, imus, settings),
///                                                   calibrateStreams(data, s, cameras, imus, other));
///
/// Both fits have the same data, so their difference is mostly smaller than the standard deviations. A larger one means
/// that the assumptions of one fit do not hold.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Differences of all IMUs and of gravity. Standard deviations are the largest of both fits, stated and clustered.
struct StreamAgreement {
  std::vector<ImuAgreement> imus;
  double gravity_angle = 0;  ///< between both directions of gravity [rad]
  /// Larger standard deviation of the direction. Multiplied by what clustering makes of the rotations of the IMUs.
  double gravity_std = unknown;
  double largest = 0;        ///< largest difference [standard deviations]
  std::string largest_name;  ///< its value: `imu0.translation.x`
  /// A sentence that names the value and the usual causes, if `largest` is more than 3; empty otherwise.
  std::string contradiction;
};

/// Compares two results of the same IMUs, in the same order. Differences are unknown (NaN) in standard deviations if a fit
/// did not succeed. Throws DataError [slom.calibration.bad-stream] if the IMUs have other names.
StreamAgreement agreementOf(const StreamResult& first, const StreamResult& second);

}  // namespace slom::calibration
