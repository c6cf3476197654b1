// The calibration as YAML that OpenCV's FileStorage reads; docs/calibrate/results.md shows how to read it.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

std::string toOpencvYaml(const Result& result);

}  // namespace slom::app::calib
