// Cross-validation: calibrates from every second image and from the others, and compares where the two calibrations
// project the same rays. The rotation between their frames is fitted first, over the image, with each place weighted
// by its uncertainty (https://mrcal.secretsauce.net/differencing.html). Residuals cannot show a model that adapts to
// its own images. Two halves that disagree by more than their noise do show it.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the images with even or odd index in the order of their numbers, without the IMU.
Dataset halfOf(const Dataset& data, int half);

/// Starts both halves from `fit`, a fit of all `data`. Throws WorkEnded if the time does not suffice for both.
SplitHalf splitHalf(const Dataset& data, const Settings& settings, const Result& fit,
                    const std::vector<ImageGrid>& grids);

}  // namespace slom::calibration
