// Errors and sentences on hand and eye.
#pragma once

#include "calibration/hand_eye/free_directions.hpp"
#include "calibration/hand_eye/robust_fit.hpp"
#include "calibration/hand_eye/start.hpp"
#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// Throws DataError if the streams have too few rows in common.
void requireCommonTime(const HandEyeStart& start, const PoseStream& hand, const PoseStream& camera,
                       const HandEyeSettings& settings);
void requireItems(const RobustFit& fit, const Streams& streams, const PoseStream& hand,
                  const PoseStream& camera);

/// Adds warnings on clocks, overlap, outliers and weak motion. If the streams do not describe one motion, `converged`
/// becomes false, and `message` says so.
void judge(const Streams& streams, const PoseStream& hand, const PoseStream& camera,
           const HandEyeSettings& settings, const HandEyeStart& start, const Freedom& freedom,
           HandEyeResult& result);

}  // namespace slom::calibration
