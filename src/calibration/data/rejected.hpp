// Gross corners that the fit leaves out (Settings::robust).
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the data without these views, and without readings of their images that no camera has any more.
Dataset withoutViews(Dataset data, const std::vector<Stray>& views);

/// Returns the data without Result::rejected and without the views that the fit left out (Stray::is_left_out).
Dataset withoutRejected(const Dataset& data, const Result& result);

/// Returns whether the recording has so many views that a single one hardly moves the lenses.
bool isLong(const Dataset& data);

/// Returns corners of Result::gross to leave out: the worst corner of a view, if it is more than 10 standard
/// deviations off and at least half as far off as the worst of all. In a long recording, all corners of a view that are
/// at least half as far off as the worst of this view. Skips a view of `data` that would then lack more than a tenth of
/// its corners.
std::vector<GrossCorner> rejectable(const Dataset& data, const Result& result);

}  // namespace slom::calibration
