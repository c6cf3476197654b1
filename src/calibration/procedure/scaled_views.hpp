// Views of images of another size than the others of their camera, such as scaled photographs.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "calibration/fit/pose_of_view.hpp"
#include "slom/calibration/calibrate.hpp"

namespace slom::calibration {

/// Returns the index of the camera in a result.
std::size_t indexOf(const Result& result, const std::string& camera);

/// Returns the RMS distance of the corners from their pixels, for the best pose of the view with the lens of a result
/// [px of the view]. `pixel_scale` scales the view's pixels to the image size of the other views. A careful look has 14
/// starts, a quick one 2.
double rmsOfBestPose(const Result& result, std::size_t c, const View& view, double pixel_scale,
                     Look look = Look::careful);

/// The size of a view's image, relative to the others, at which its corners fit.
struct ImageScale {
  double size = 1, rms_px = 0;
};
/// Returns nothing if the view fits as well at the size of the others. `result`: a fit without the view. `preferred`:
/// a size to take if it fits nearly as well as the best one, because images are mostly scaled alike.
std::optional<ImageScale> scaleOf(const Result& result, std::size_t c, const View& view, double preferred,
                                  Look look = Look::careful);

/// Returns whether some view fits at another size, with lenses fitted without a fifth of the images each. Needs a few
/// fits, whereas comparing every view with all others needs as many fits as there are views. With more than 80 images,
/// viewsOfAnotherSize needs no fits, and the answer is yes.
bool maybeOfAnotherSize(const Dataset& data, const Settings& settings, const Result& result);

/// Returns the decrease of chi-square if these views are scaled to the size of the others, in units of the noise
/// after scaling. `with_all`: the fit of the data without scaling.
double gainOfScaling(Dataset data, const Settings& settings, const Result& with_all,
                     const std::vector<Stray>& views);

/// Finds views by trial, for fits so bad that their lens says nothing. Scales the view, by 2 or 1/2, that improves
/// the fit of all views most, and repeats this.
std::vector<Stray> viewsToScale(Dataset data, Settings settings, double rss, std::size_t most_views);

/// Finds views of images of another size one by one. Compares each with a fit of the others, because a fit with the
/// view follows it. Of more than 80 images, compares the worst views with the fit of all. `result`: the fit of all
/// `data`. `is_first`: whether no view of another size is known yet. `is_enough`: whether data suffice without the
/// views left out.
std::vector<Stray> viewsOfAnotherSize(Dataset data, const Settings& settings, const Result& result,
                                      bool is_first, const std::function<bool(const Dataset&)>& is_enough);

}  // namespace slom::calibration
