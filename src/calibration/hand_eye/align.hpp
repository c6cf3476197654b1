// The time offset of two streams, from how fast they move.
#pragma once

#include <vector>

#include "calibration/hand_eye/streams.hpp"

namespace slom::calibration {

/// A shift at which the speeds of both streams agree.
struct ShiftCandidate {
  double shift = 0;        ///< [s]
  double correlation = 0;  ///< of the speeds, -1 to 1
  double overlap = 0;      ///< [s]
  double score = 0;        ///< Fisher's z times the root of the number of samples
};

/// Returns the best shifts over the whole range in which the streams overlap, the best first. Angular speeds are
/// compared or, if they say nothing, speeds: neither depends on frames. Empty: the streams are too short.
std::vector<ShiftCandidate> shiftCandidates(const Streams& streams, const PoseStream& hand,
                                            const PoseStream& camera);

}  // namespace slom::calibration
