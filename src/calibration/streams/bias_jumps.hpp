// Biases that jump and stay. A restart of the sensor or a jolt may cause a jump.
#pragma once

#include <string>
#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Finds these jumps, for each IMU, in the order of time: fits all with walks that are nearly free, and looks for steps of
/// the biases. Gross readings may be there: they hardly count. Returns none if the fit fails.
std::vector<std::vector<BiasJump>> findBiasJumps(const Dataset& data, const Settings& settings,
                                                 const CamerasAt& cameras,
                                                 const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                                                 const std::vector<StartedImu>& imus, double gravity);

/// Subtracts the jumps from the readings behind them, and removes the readings around them.
void removeJumps(const std::vector<BiasJump>& jumps, ImuStream& imu);

/// Returns the standard deviation of a bias's increment from one time to another, in the clock of the IMU: that of the walk
/// or, if the bias jumps between, as much as a jump that is not known well.
double incrementDeviation(const std::vector<BiasJump>& jumps, bool is_gyro, double density, double from,
                          double to);

/// Returns the time of the first jump of a sensor's bias; infinite if there is none.
double firstJump(const std::vector<BiasJump>& jumps, bool is_gyro);

/// Returns the sentence for the report. Empty if there are none.
std::string noteOn(const std::vector<BiasJump>& jumps, const ImuStream& imu);

}  // namespace slom::calibration
