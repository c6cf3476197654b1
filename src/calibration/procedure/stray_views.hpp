// A second look where a fit fails, or leaves corners farther off than detection explains: which views it does not fit, and whether
// the others fit without them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "slom/calibration/calibrate.hpp"

namespace slom::calibration {

/// Whether corners are farther off than detection explains: the fit failed, the RMS of all corners or of a view is several times what is stated, or
/// what the other views show.
bool isBadFit(const Result& result, const Settings& settings);

/// A fit of some of the data, from the beginning.
using Fit = std::function<Result(const Dataset&)>;

/// Looks for views without which the others fit: those whose corners disagree among themselves, or else the worst ones, one by one, up to a third. Of the
/// fit without them, `strays` has those that no pose fits, Stray::is_left_out; views that do fit are taken back. Nothing where no fit gets much
/// better. `bad`: the fit of all views, if there is one.
std::optional<Result> withoutStrayViews(const Dataset& data, const Settings& settings, const Result* bad,
                                        const Fit& fit);

/// Of a fit that looks good: the one without views of images of another size, which the lens followed; nothing where there are none.
std::optional<Result> withoutScaledViews(const Dataset& data, const Settings& settings, const Result& good,
                                         const Fit& fit);

/// The same of a bad fit of one camera that leaving out views does not mend: by trying to scale each of at most 20 views.
std::optional<Result> withoutViewsToScale(const Dataset& data, const Settings& settings, const Result& bad,
                                          const Fit& fit);

/// Sets Result::better_model, causes and, where all boards are nearly parallel, undetermined, of a fit that is bad.
void nameCauses(const Dataset& data, const Settings& settings, Result& result);

/// Of cameras most of whose views contradict the others: whether their corners are counted from another end of the board. Then that is the cause of the strays.
void nameOtherEnd(const Dataset& data, const Fit& fit, Result& result);

}  // namespace slom::calibration
