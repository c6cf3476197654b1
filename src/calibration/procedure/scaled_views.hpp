// Views of images of another size than the others of their camera, as scaled photographs are.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "slom/calibration/calibrate.hpp"

namespace slom::calibration {

/// The place of a camera in a result.
std::size_t indexOf(const Result& result, const std::string& camera);

/// The median RMS of a camera's images [px].
double usualRms(const Result& result, std::size_t c);

/// From how many starts a pose is looked for, and how exactly.
enum class Look { careful, quick };

/// The RMS distance of the corners from their pixels, for the best pose of the view before the lens of a result [px of the view]. `pixel_scale`: what brings
/// the view's pixels to the size of the others'.
double rmsOfBestPose(const Result& result, std::size_t c, const View& view, double pixel_scale,
                     Look look = Look::careful);

/// The size of a view's image over that of the others, at which its corners fit.
struct ImageScale {
  double size = 1, rms_px = 0;
};
/// Nothing where the view fits as well at the size of the others. `result`: a fit without the view. `preferred`: a size that is taken if it fits nearly as well as
/// the best one, as images are mostly scaled alike.
std::optional<ImageScale> scaleOf(const Result& result, std::size_t c, const View& view, double preferred,
                                  Look look = Look::careful);

/// Whether some view fits at another size before the lens that fifths of the images without it give: a few fits, where comparing every view with all others
/// takes as many as there are views.
bool maybeOfAnotherSize(const Dataset& data, const Settings& settings, const Result& result);

/// By how much chi-square falls, of the noise that then is left, if views are brought to the size of the others. `with_all`: the fit of the data as they are.
double gainOfScaling(Dataset data, const Settings& settings, const Result& with_all,
                     const std::vector<Stray>& views);

/// Views without whose scaling no fit is good, found by trial: whichever scaling of one view by 2 or 1/2 brings the fit of all down most, again and again. For fits so bad
/// that no lens of theirs says anything.
std::vector<Stray> viewsToScale(Dataset data, Settings settings, double rss, std::size_t most_views);

/// Views of images of another size, found one by one: each is compared with a fit of the others, as a fit that has it follows it. `result`: the fit of all `data`.
/// `is_enough`: whether data can do without those left out.
std::vector<Stray> viewsOfAnotherSize(Dataset data, const Settings& settings, const Result& result,
                                      const std::function<bool(const Dataset&)>& is_enough);

}  // namespace slom::calibration
