// Start values of hand and eye at a known time offset, by linear equations that gross errors do not spoil.
#pragma once

#include "calibration/hand_eye/streams.hpp"
#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// A pose as another reading of its stream has it.
struct PoseReading : OtherReading {
  bool is_inverted = false;  ///< PoseStream::is_inverted
  SE3 operator()(const SE3& pose) const;
};
struct PoseReadings {
  PoseReading hand, camera;
};

/// Start values, and how well they explain the motions.
struct HandEyeStart {
  HandEyeValues values;
  double misfit_rad = 0;  ///< median difference of rotation vectors of motions
  double turn_rad = 0;    ///< median turn of motions
  double misfit_m = 0;    ///< median difference of positions
  int rows = 0;
  double alike_shift = 0;  ///< shift at which the speeds of both streams agree best, whatever their frames
  /// Misfit relative to the size of the motions.
  double relativeMisfit() const { return misfit_rad / std::max(turn_rad, 1e-300); }
};

/// Returns start values at a shift. Whatever the motion leaves free has some value. Needs 3 common rows.
HandEyeStart startAt(const Streams& streams, double shift, const HandEyeSettings& settings,
                     const PoseReadings& readings = {});

}  // namespace slom::calibration
