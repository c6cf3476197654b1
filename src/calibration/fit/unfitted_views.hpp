// Views that contradict the others: where start values put them, and what the fit makes of them.
#pragma once

#include <vector>

#include "calibration/initialization/rig.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns views most of whose corners lie more than 10 px, and ten times as far as those of most views, from where the rig puts them. In most
/// cases these images were not taken at the same time. Single corners that are farther off are another matter.
std::vector<Stray> findStrays(const Dataset& data, const std::vector<Lens>& cameras, const RigStart& rig);

/// Removes strays that the fit fits like the other views of their camera: the start values were far off there, not the images.
void keepUnfitted(Result& result);

/// Whether the strays are most views of some camera. Its image numbers are not those of the others, and no fit of all is to be expected.
bool areMost(const std::vector<Stray>& strays, const Dataset& data);

}  // namespace slom::calibration
