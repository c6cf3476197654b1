// Readings that no motion explains: single ones, as of a disturbed transfer, and those that stay the same for a while.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Readings that jump: those whose second difference is more than 30 times that of readings around.
struct Spikes {
  std::vector<ImuSpike> all;  ///< in the order of time
  std::size_t kept = 0;       ///< readings that jump, if they are more than a hundredth: then `all` is empty
};
Spikes spikesOf(const ImuStream& imu);

/// Returns the stream without these readings.
ImuStream withoutSpikes(ImuStream imu, const std::vector<ImuSpike>& spikes);

/// Returns the times between which axes read exactly the same, as of a sensor that hangs, in the order of time: 20 readings
/// or more, over 0.2 s or more, while another axis moves or with a step at an end. The largest readings of an axis do
/// not count: a saturated sensor stays there.
std::vector<GrossReadings> stuckReadings(const ImuStream& imu);

/// Returns the sentence for the report on these readings. Empty if there are none.
std::string noteOnStuck(const std::vector<GrossReadings>& stuck, const ImuStream& imu);

/// Returns the sentence for the report. Empty if no reading jumps.
std::string noteOn(const Spikes& spikes, const ImuStream& imu);

}  // namespace slom::calibration
