// Gross corners that a fit does without (Settings::robust).
#pragma once

#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The data without these views, and without readings of images that no camera has then.
Dataset withoutViews(Dataset data, const std::vector<Stray>& views);

/// The data without Result::rejected and without the views that the fit left out (Stray::is_left_out).
Dataset withoutRejected(const Dataset& data, const Result& result);

/// Corners of Result::gross to do without: the worst one of a view where it is more than 10 standard deviations off, and at least half as far as the worst
/// of all, unless the view, in `data`, then lacks more than a tenth of its corners.
std::vector<GrossCorner> rejectable(const Dataset& data, const Result& result);

}  // namespace slom::calibration
