// The streams of a calibration without wrong readings.
#pragma once

#include <vector>

#include "calibration/streams/bias_jumps.hpp"
#include "calibration/streams/force_lag.hpp"
#include "calibration/streams/gross_readings.hpp"
#include "calibration/streams/spikes.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

class UsableStreams {
 public:
  /// Leaves out readings that stay the same or jump, except with Robust::none. Throws the errors of requireGoodStream(). `imus` must outlive
  /// this object.
  UsableStreams(const std::vector<ImuStream>& imus, Robust robust);
  UsableStreams(const UsableStreams&) = delete;
  UsableStreams& operator=(const UsableStreams&) = delete;

  /// The streams stay where they are, also when readings are removed.
  const std::vector<ImuStream>& streams() const { return used_; }
  /// Returns whether wrong readings are removed.
  bool isRobust() const { return robust_ != Robust::none; }
  /// Removes readings, by IMU. Returns whether there are any. Does nothing with Robust::none.
  bool remove(std::vector<std::vector<GrossReadings>> gross);
  /// Removes jumps of biases from the readings, by IMU. Returns whether there are any. Does nothing with Robust::none.
  bool remove(std::vector<std::vector<BiasJump>> jumps);
  /// Removes lags of accelerometers from the readings, by IMU. Returns whether there are any.
  bool remove(const ForceLags& lags);
  /// Returns the jumps, by IMU.
  const std::vector<std::vector<BiasJump>>& jumps() const { return jumps_; }
  /// Adds to the result what was left out, and says so in front of other notes.
  void report(StreamResult& result) const;

 private:
  const std::vector<ImuStream>& given_;
  Robust robust_;
  std::vector<ImuStream> used_;
  std::vector<std::vector<GrossReadings>> stuck_;
  std::vector<Spikes> spikes_;
  std::vector<std::vector<GrossReadings>> gross_;
  std::vector<std::vector<BiasJump>> jumps_;
};

}  // namespace slom::calibration
