// All that is to be known about how far a calibration can be trusted.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// After a fit that failed: residuals alone. Takes about as long as the calibration.
Quality assess(const Dataset& data, const Settings& settings, const Result& result);

}  // namespace slom::calibration
