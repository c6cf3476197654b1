// Which of several models predicts best.
#pragma once

#include "slom/calibration/comparison.hpp"

namespace slom::calibration {

/// From the trials: best, standard errors and choice. The logarithm of the ratio of a model's squares to the best one's is averaged over the images,
/// and its standard error follows from how much it varies between them.
void judge(Comparison& comparison);

}  // namespace slom::calibration
