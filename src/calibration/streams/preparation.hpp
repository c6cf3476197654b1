// What comes before a fit of IMUs in motion: readings without what is wrong, and values and noise to begin with.
#pragma once

#include <cstdint>
#include <vector>

#include "calibration/streams/force_lag.hpp"
#include "calibration/streams/usable_streams.hpp"

namespace slom::calibration {

/// What a fit begins with.
struct StreamStart {
  Settings settings;
  CamerasAt cameras;
  std::vector<StartedImu> imus;
  mtk::S2<> up;
};

struct PreparedStreams {
  StreamStart start;  ///< values and noise of a fit by preintegration or, if that failed, those before
  ForceLags lags;     ///< that the streams no longer have
};

/// Removes jumps of biases, gross readings and lags from the streams, and estimates noise and values by preintegration.
/// `cameras`: values of the cameras' own fit. `epoch_ns`: zero of the times of the images.
PreparedStreams prepare(const Dataset& data, const std::vector<RigAtImage>& images, std::int64_t epoch_ns,
                        const Settings& settings, const CamerasAt& cameras, const StreamSettings& stream,
                        UsableStreams& usable);

}  // namespace slom::calibration
