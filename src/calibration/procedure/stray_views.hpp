// A second look if a fit fails, or leaves corners farther off than detection explains. Finds views that it does not
// fit, and checks whether the others fit without them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "slom/calibration/calibrate.hpp"

namespace slom::calibration {

/// Returns whether corners are farther off than detection explains: the fit failed, or the RMS of all corners or of a
/// view is several times the stated noise. The RMS of a view must also be several times that of other views.
bool isBadFit(const Result& result, const Settings& settings);

/// A fit of some of the data, from the beginning.
using Fit = std::function<Result(const Dataset&)>;

/// Looks for views without which the others fit: views whose corners are inconsistent, or else the worst ones, one by
/// one, up to a third. Returns the fit without them. Its `strays` holds the views that no pose fits, as
/// Stray::is_left_out; views that do fit are taken back. Returns nothing if no fit gets much better. `bad`: the fit
/// of all views, if there is one.
std::optional<Result> withoutStrayViews(const Dataset& data, const Settings& settings, const Result* bad,
                                        const Fit& fit);

/// Returns, for a fit that looks good, a fit without views of images of another size, which the lens followed.
/// Returns nothing if there are none.
std::optional<Result> withoutScaledViews(const Dataset& data, const Settings& settings, const Result& good,
                                         const Fit& fit);

/// Returns the same for a bad fit of one camera that leaving out views does not improve. Tries to scale each of at
/// most 20 views.
std::optional<Result> withoutViewsToScale(const Dataset& data, const Settings& settings, const Result& bad,
                                          const Fit& fit);

/// Returns, for a rig whose fit is bad or fails (null), a fit without views that no pose fits, such as views of another
/// size. In a rig, such a view may seem right, and the view of another camera at the same time wrong. So looks at each
/// camera alone, by `fit_with_second_look`. If that finds nothing, compares all views of the images that seem wrong with
/// a fit of the other images.
std::optional<Result> withoutUnfitViewsOfRig(const Dataset& data, const Settings& settings, const Result* bad,
                                             const Fit& fit, const Fit& fit_with_second_look);

/// Sets Result::better_model and causes of a bad fit, and undetermined if all boards are nearly parallel.
void nameCauses(const Dataset& data, const Settings& settings, Result& result);

/// Checks, for cameras most of whose views contradict the others, whether their corners are counted from another end
/// of the board. If so, sets that as the cause of the strays.
void nameOtherEnd(const Dataset& data, const Fit& fit, Result& result);

}  // namespace slom::calibration
