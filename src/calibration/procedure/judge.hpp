// The choice of the model that predicts best.
#pragma once

#include "slom/calibration/comparison.hpp"

namespace slom::calibration {

/// Sets best model, standard errors and choice from the trials. Averages the logarithm of the ratio of a model's
/// squares to the best one's over the images. The standard error follows from the variation between images.
void judge(Comparison& comparison);

}  // namespace slom::calibration
