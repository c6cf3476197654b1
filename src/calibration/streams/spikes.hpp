// Single readings that no motion explains, such as those of a disturbed transfer.
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

/// Returns the sentence for the report. Empty if no reading jumps.
std::string noteOn(const Spikes& spikes, const ImuStream& imu);

}  // namespace slom::calibration
