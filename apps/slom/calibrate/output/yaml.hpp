// The calibration as YAML that OpenCV's FileStorage reads; docs/calibrate.md lists the keys.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

std::string toOpencvYaml(const Result& result);

}  // namespace slom::app::calib
