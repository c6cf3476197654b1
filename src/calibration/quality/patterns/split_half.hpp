// Cross-validation: calibrates from every second image and from the others, and compares where the two
// project the same rays to. The rotation between their frames that the two imply is fitted out first, over
// the image, each place weighted by how well it is known (https://mrcal.secretsauce.net/differencing.html).
// Residuals cannot show a model that bends to its own images; two halves that disagree by more than their
// noise do.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The images of even or of odd place in the order of their numbers, without the IMU.
Dataset halfOf(const Dataset& data, int half);

/// `fit` was found from all `data` and is the start of both halves. WorkEnded when there is no time left for
/// both.
SplitHalf splitHalf(const Dataset& data, const Settings& settings, const Result& fit,
                    const std::vector<ImageGrid>& grids);

}  // namespace slom::calibration
