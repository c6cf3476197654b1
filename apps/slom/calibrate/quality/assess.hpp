// All that is to be known about how far a calibration can be trusted.
#pragma once

#include "calibrate/input/dataset.hpp"
#include "calibrate/quality/quality.hpp"
#include "calibrate/result.hpp"

namespace slom::app::calib {

/// After a fit that failed: residuals alone. Takes about as long as the calibration.
Quality assess(const Dataset& data, const Settings& settings, const Result& result);

}  // namespace slom::app::calib
