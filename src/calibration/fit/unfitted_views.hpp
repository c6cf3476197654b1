// Views that contradict the others by the start values, and by the fit.
#pragma once

#include <vector>

#include "calibration/initialization/rig.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns views whose median corner is more than 10 px, and more than ten times the usual distance, from where the
/// rig puts it. In most cases these images were not taken at the same time. Single corners that are farther off are
/// handled elsewhere.
std::vector<Stray> findStrays(const Dataset& data, const std::vector<Lens>& cameras, const RigStart& rig);

/// Returns the median RMS of a camera's images [px].
double usualRms(const Result& result, std::size_t camera);

/// Removes strays that the fit matches as well as the other views of their camera. For these, the start values were
/// far off, not the images.
void keepUnfitted(Result& result);

/// Returns whether the strays are most views of some camera. Then its image numbers do not belong to those of the
/// others, and a fit of all images is unlikely.
bool areMost(const std::vector<Stray>& strays, const Dataset& data);

}  // namespace slom::calibration
