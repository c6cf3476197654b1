#include "calibration/models/define.hpp"
#include "calibration/models/opencv.hpp"

SLOM_CALIBRATION_DEFINE_MODEL(opencv5, Opencv5)
