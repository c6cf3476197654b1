// Streams that describe one motion if their poses are read in another way.
#pragma once

#include <string>

#include "calibration/hand_eye/streams.hpp"
#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// Sets `hand_seems` and `camera_seems` of the result to the readings with which the streams agree far better at a shift.
/// Returns whether there are such.
bool findOtherReading(const Streams& streams, const PoseStream& hand, const PoseStream& camera, double shift,
                      const HandEyeSettings& settings, HandEyeResult& result);

/// Returns what agrees far better, and what to do.
std::string sentenceOnReading(const PoseStream& hand, const std::string& hand_name, const PoseStream& camera,
                              const std::string& camera_name, const HandEyeResult& result);

}  // namespace slom::calibration
