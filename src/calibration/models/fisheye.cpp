#include "calibration/models/fisheye.hpp"

#include "calibration/models/define.hpp"

SLOM_CALIBRATION_DEFINE_MODEL(fisheye, Fisheye)
