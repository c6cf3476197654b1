// Compared models as people read them.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// A table, and which model to take.
std::string comparisonText(const Comparison& comparison);

}  // namespace slom::app::calib
