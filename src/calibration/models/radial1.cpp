#include "calibration/models/define.hpp"
#include "calibration/models/opencv.hpp"

SLOM_CALIBRATION_DEFINE_MODEL(radial1, Radial1)
