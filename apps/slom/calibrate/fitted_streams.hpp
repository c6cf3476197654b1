// IMUs in motion, as they were fitted.
#pragma once

#include <optional>
#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// The fit, and how far both ways to fit agree; or why the readings were refused. Then there is no fit.
struct FittedStreams {
  StreamResult result;
  std::optional<StreamAgreement> agreement{};  ///< with --imu-motion both
  Verdict verdict{};
  std::string refusal{};  ///< sentence; empty: the readings were fitted

  bool success() const { return result.success(); }
};

}  // namespace slom::app::calib
