// The fit of the rig from known values, and what models are compared by.
#pragma once

#include "mtk/error.hpp"
#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/comparison.hpp"

namespace slom::calibration {

/// Only the fit of the rig, of images that are among those of an earlier result, from the values found there. An IMU is left
/// out.
Result calibrateFrom(const Result& start, const Dataset& data, const Settings& settings);

/// From the trials: best, standard errors and choice. The logarithm of the ratio of a model's squares to the
/// best one's is averaged over the images, and its standard error follows from how much it varies between
/// them.
void judge(Comparison& comparison);

/// The fault alone, without the library's id and without the remedy, which is for programmers.
std::string sentenceOf(const mtk::Error& error);

}  // namespace slom::calibration
