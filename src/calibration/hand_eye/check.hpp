// Checks of streams and settings before anything is computed.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// Throws DataError if streams or settings cannot be used.
void checkStreams(const PoseStream& hand, const PoseStream& camera, const HandEyeSettings& settings);

/// Returns sentences on equal stamps and gaps of a stream.
std::vector<std::string> noticesOf(const PoseStream& stream);

/// Returns a sentence if the names of both files say that hand and camera are exchanged; empty: they do not.
std::string noticeOfNames(const PoseStream& hand, const PoseStream& camera);

}  // namespace slom::calibration
