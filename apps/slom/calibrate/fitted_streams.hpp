// IMUs in motion, as they were fitted.
#pragma once

#include <optional>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// The fit, and how far both ways to fit agree.
struct FittedStreams {
  StreamResult result;
  std::optional<StreamAgreement> agreement{};  ///< with --imu-motion both
  Verdict verdict{};

  bool success() const { return result.success(); }
};

}  // namespace slom::app::calib
