// Single readings that no motion explains, such as those of a disturbed transfer.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Returns the readings that jump: those whose second difference is more than 30 times that of readings around, in the
/// order of time. Returns none if they are more than a hundredth of all, as in a stream of knocks.
std::vector<ImuSpike> spikesOf(const ImuStream& imu);

/// Returns the stream without these readings.
ImuStream withoutSpikes(ImuStream imu, const std::vector<ImuSpike>& spikes);

/// Returns the sentence for the report. Empty if there are no spikes.
std::string noteOn(const std::vector<ImuSpike>& spikes, const ImuStream& imu);

}  // namespace slom::calibration
