// Whether the halves of a recording agree.
#pragma once

#include <functional>
#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Poses and clocks of the IMUs of a fit, with stated standard deviations. Empty: it did not converge.
using PosesOfImus = std::vector<ImuStreamResult>;

/// Adds how far fits to the readings of both halves of the recording differ. `imus`: values and noise of the whole fit,
/// which has succeeded. `fit` may throw slom::Error. Clustering is taken to enlarge the standard deviations of the halves
/// by the same factor as those of the whole fit.
void addHalves(const std::vector<StartedImu>& imus, const std::vector<RigAtImage>& images,
               const std::function<PosesOfImus(const std::vector<StartedImu>&)>& fit, StreamResult& result);

}  // namespace slom::calibration
