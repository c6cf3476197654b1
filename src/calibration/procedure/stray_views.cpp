#include "calibration/procedure/stray_views.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calibration/data/check.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/fit/model_fit.hpp"
#include "calibration/fit/unfitted_views.hpp"
#include "calibration/initialization/view_misfit.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/procedure/scaled_views.hpp"
#include "calibration/side_by_side.hpp"
#include "slom/calibration/assess.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double least_bad_px = 1, bad_sigmas = 4;  // RMS beyond which the procedure takes another look
constexpr double much_worse_view = 3.5;             // RMS of a view over the median of its camera
constexpr double much_better = 0.5;                 // RMS of all without the strays over that with them

double explainedPx(const Settings& settings) {
  return std::max(least_bad_px, bad_sigmas * settings.sigma_px);
}

struct ViewRms {
  Stray view;
  double over_median;
};

/// Returns the views of all cameras, the worst first.
std::vector<ViewRms> viewsByRms(const Result& result) {
  std::vector<ViewRms> views;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    std::vector<double> all;
    for (const ImageResult& image : result.images) {
      if (image.rms_px[c]) all.push_back(*image.rms_px[c]);
    }
    const double median = medianOf(all);
    for (const ImageResult& image : result.images) {
      if (!image.rms_px[c]) continue;
      views.push_back({{result.cameras[c].name, image.image, *image.rms_px[c]}, *image.rms_px[c] / median});
    }
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const ViewRms& a, const ViewRms& b) { return a.view.error_px > b.view.error_px; });
  return views;
}

bool isBadView(const ViewRms& one, const Settings& settings) {
  return one.view.error_px > explainedPx(settings) && one.over_median > much_worse_view;
}

std::size_t countViews(const Dataset& data) {
  std::size_t count = 0;
  for (const CameraData& camera : data.cameras) count += camera.views.size();
  return count;
}

/// Returns whether enough views of each camera are left, connected as before.
bool suffices(const Dataset& rest, const Dataset& all) {
  for (std::size_t c = 0; c < rest.cameras.size(); ++c) {
    const std::size_t left = rest.cameras[c].views.size();
    if (left < 3 || 3 * left < 2 * all.cameras[c].views.size()) return false;
  }
  return isStillConnected(rest);
}

/// Returns views whose corners are inconsistent: far off any smooth map, and much farther than in other views of
/// their camera.
std::vector<Stray> viewsThatDisagree(const Dataset& data, const Settings& settings) {
  constexpr double least_part = 0.005, over_median = 4;
  std::vector<Stray> found;
  for (const CameraData& camera : data.cameras) {
    std::vector<ViewMisfit> misfits(camera.views.size());
    sideBySide(misfits.size(), [&](std::size_t i) { misfits[i] = misfitOf(camera.views[i]); });
    std::vector<double> parts, distances;
    for (const ViewMisfit& misfit : misfits) {
      parts.push_back(misfit.part());
      distances.push_back(misfit.px);
    }
    const double usual = medianOf(parts), usual_px = medianOf(distances);
    for (std::size_t i = 0; i < misfits.size(); ++i) {
      if (misfits[i].part() < std::max(least_part, over_median * usual) ||
          misfits[i].px < 2 * settings.sigma_px)
        continue;
      found.push_back({.camera = camera.name,
                       .image = camera.views[i].image,
                       .error_px = misfits[i].px,
                       .photo = camera.views[i].photo,
                       .is_left_out = true,
                       .why = fmt::format("corners disagree by {} px, in other images by {} px",
                                          twoDigits(misfits[i].px), twoDigits(usual_px))});
    }
  }
  return found;
}

std::optional<Result> fitted(const Fit& fit, const Dataset& data) {
  try {
    return fit(data);
  } catch (const slom::Error&) {  // the rest has no start values either
    return {};
  }
}

/// Returns the views that no pose fits, with the cause if it is known.
std::vector<Stray> judged(const std::vector<Stray>& views, const Dataset& data, const Result& result) {
  std::vector<Stray> strays;
  for (Stray stray : views) {
    const std::size_t c = indexOf(result, stray.camera);
    const View& view = *data.cameras[c].find(stray.image);
    const double usual = std::max(usualRms(result, c), 1e-3);
    stray.error_px = rmsOfBestPose(result, c, view, 1);
    const std::optional<ImageScale> scale = scaleOf(result, c, view, strays.empty() ? 1 : strays.back().size);
    if (stray.error_px <= 3 * usual && !scale) continue;
    stray.is_left_out = true;
    stray.photo = view.photo;
    if (scale) {
      stray.size = scale->size;
      stray.why = fmt::format("at {:.3g} times the size of the other images, corners fit to {} px",
                              scale->size, twoDigits(scale->rms_px));
    }
    strays.push_back(std::move(stray));
  }
  return strays;
}

std::vector<Stray> sortedByImage(std::vector<Stray> strays) {
  std::stable_sort(strays.begin(), strays.end(),
                   [](const Stray& a, const Stray& b) { return a.image < b.image; });
  return strays;
}

/// Extends the strays by further views of images of another size, which a fit with them follows. If there are any,
/// replaces `without` by a fit without all of them.
void addScaledViews(const Dataset& data, const Settings& settings, const Fit& fit, Result& without,
                    std::vector<Stray>& strays) {
  const bool has_scaled =
      std::any_of(strays.begin(), strays.end(), [](const Stray& stray) { return stray.size != 1; });
  if (!has_scaled) return;
  const auto isEnough = [&](const Dataset& rest) { return suffices(rest, data); };
  const std::vector<Stray> more =
      viewsOfAnotherSize(withoutViews(data, strays), settings, without, false, isEnough);
  if (more.empty()) return;
  std::vector<Stray> all = strays;
  all.insert(all.end(), more.begin(), more.end());
  std::optional<Result> next = fitted(fit, withoutViews(data, all));
  if (!next || !next->success() || !next->strays.empty()) return;
  without = std::move(*next);
  strays = judged(all, data, without);
}

/// Returns whether the fit without the views is much better.
bool isBetter(const Result& without, const Result* bad, const Settings& settings) {
  if (!without.success() || !without.strays.empty()) return false;
  if (!bad || !bad->success() || !bad->strays.empty()) return rmsOfAll(without) < explainedPx(settings);
  return rmsOfAll(without) < much_better * rmsOfAll(*bad) || !isBadFit(without, settings);
}

struct WithoutWorst {
  Result result;
  std::vector<Stray> gone;
};

/// Returns the views to leave out next: the worst one and, in a long recording, all that make the fit a bad one.
std::vector<Stray> nextToLeaveOut(const std::vector<ViewRms>& views, const Settings& settings, bool is_long) {
  std::vector<Stray> next{views.front().view};
  for (std::size_t i = 1; i < views.size() && is_long && isBadView(views[i], settings); ++i)
    next.push_back(views[i].view);
  return next;
}

/// Leaves out the worst view repeatedly, until the fit is good and the next view changes little.
std::optional<WithoutWorst> withoutWorst(const Dataset& data, const Settings& settings, const Result& bad) {
  constexpr std::size_t most_tried = 12;
  constexpr double little = 0.8;    // RMS over the RMS with one view more
  constexpr double suspicious = 2;  // RMS of the view over the median of its camera
  const bool is_long = isLong(data);
  WithoutWorst current{bad, {}};
  std::optional<WithoutWorst> good;
  while (current.gone.size() < std::min(most_tried, countViews(data) / 3)) {
    if (!reasonToEnd(settings.limits).empty()) break;
    const std::vector<ViewRms> views = viewsByRms(current.result);
    if (views.empty() || (good && views.front().over_median < suspicious)) break;
    for (Stray& next : nextToLeaveOut(views, settings, is_long)) current.gone.push_back(std::move(next));
    Dataset rest = withoutViews(data, current.gone);
    if (!suffices(rest, data)) break;
    rest.imu.reset();
    try {
      current.result = calibrateModelFrom(current.result, rest, settings, rough_deviations);
    } catch (const slom::Error&) {
      break;
    }
    if (isBadFit(current.result, settings)) continue;
    if (good && rmsOfAll(current.result) > little * rmsOfAll(good->result)) break;
    good = current;
  }
  return good;
}

/// Returns whether a fit without the views, which starts from the bad one, is much better. Only for long recordings, in
/// which the bad fit is a good start; then a fit from the beginning is worth its time.
bool mayBeBetter(const Dataset& data, const std::vector<Stray>& suspects, const Settings& settings,
                 const Result* bad) {
  if (!isLong(data) || !bad || !bad->success() || !bad->strays.empty() || data.imu) return true;
  const Dataset rest = withoutRejected(withoutViews(data, suspects), *bad);
  const std::optional<Result> quick = fitted(
      [&](const Dataset& some) { return calibrateModelFrom(*bad, some, settings, rough_deviations); }, rest);
  return quick && isBetter(*quick, bad, settings);
}

}  // namespace

std::optional<Result> withoutScaledViews(const Dataset& data, const Settings& settings, const Result& good,
                                         const Fit& fit) {
  constexpr double least_gain = 50;  // of chi-square, with the same number of unknowns
  Dataset used = withoutRejected(data, good);
  used.imu.reset();
  if (!maybeOfAnotherSize(used, settings, good)) return {};
  const auto isEnough = [&](const Dataset& rest) { return suffices(rest, used); };
  const std::vector<Stray> scaled = viewsOfAnotherSize(used, settings, good, true, isEnough);
  if (scaled.empty() || gainOfScaling(used, settings, good, scaled) < least_gain) return {};
  std::optional<Result> without = fitted(fit, withoutViews(data, scaled));
  if (!without || !without->success() || !without->strays.empty()) return {};
  without->strays = sortedByImage(judged(scaled, data, *without));
  if (without->strays.size() < scaled.size()) return {};
  return without;
}

std::optional<Result> withoutViewsToScale(const Dataset& data, const Settings& settings, const Result& bad,
                                          const Fit& fit) {
  if (!bad.success() || !bad.strays.empty()) return {};
  const std::vector<Stray> scaled = viewsToScale(data, settings, bad.rss, countViews(data) / 3);
  if (scaled.empty()) return {};
  std::optional<Result> without = fitted(fit, withoutViews(data, scaled));
  if (!without || !without->success() || isBadFit(*without, settings)) return {};
  std::vector<Stray> strays = judged(scaled, data, *without);
  const bool are_all_scaled =
      strays.size() == scaled.size() &&
      std::all_of(strays.begin(), strays.end(), [](const Stray& one) { return one.size != 1; });
  if (!are_all_scaled) return {};
  without->strays = sortedByImage(std::move(strays));
  return without;
}

namespace {

/// Returns the views of another size that a second look at each camera alone finds.
std::vector<Stray> scaledViewsOfEachCamera(const Dataset& data, const Fit& fit_with_second_look) {
  std::vector<Stray> scaled;
  for (const CameraData& camera : data.cameras) {
    Dataset alone;
    alone.cameras.push_back(camera);
    const std::optional<Result> found = fitted(fit_with_second_look, alone);
    if (!found) continue;
    std::copy_if(found->strays.begin(), found->strays.end(), std::back_inserter(scaled),
                 [](const Stray& stray) { return stray.size != 1; });
  }
  return scaled;
}

/// Returns the views that no pose fits, among the images of which a bad fit of a rig has a stray.
std::vector<Stray> unfitOfWorstImages(const Dataset& data, const Settings& settings, const Result& bad,
                                      const Fit& fit) {
  std::set<int> images;
  for (const Stray& stray : bad.strays) images.insert(stray.image);
  const Dataset others = data.withImages([&](int image) { return images.count(image) == 0; });
  if (images.empty() || !suffices(others, data)) return {};
  const std::optional<Result> good = fitted(fit, others);
  if (!good || !good->strays.empty() || isBadFit(*good, settings)) return {};
  std::vector<Stray> views;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      if (images.count(view.image) > 0) views.push_back({.camera = camera.name, .image = view.image});
    }
  }
  return judged(views, data, *good);
}

}  // namespace

std::optional<Result> withoutUnfitViewsOfRig(const Dataset& data, const Settings& settings, const Result* bad,
                                             const Fit& fit, const Fit& fit_with_second_look) {
  if (data.cameras.size() == 1) return {};
  std::vector<Stray> unfit;
  if (!isLong(data)) unfit = scaledViewsOfEachCamera(data, fit_with_second_look);
  if (unfit.empty() && bad) unfit = unfitOfWorstImages(data, settings, *bad, fit);
  if (unfit.empty()) return {};
  std::optional<Result> without = fitted(fit, withoutViews(data, unfit));
  if (!without || !without->strays.empty() || isBadFit(*without, settings)) return {};
  without->strays = sortedByImage(judged(unfit, data, *without));
  if (without->strays.size() < unfit.size()) return {};
  return without;
}

bool isBadFit(const Result& result, const Settings& settings) {
  if (!result.success()) return true;
  if (rmsOfAll(result) > explainedPx(settings)) return true;
  const std::vector<ViewRms> views = viewsByRms(result);
  return std::any_of(views.begin(), views.end(),
                     [&](const ViewRms& one) { return isBadView(one, settings); });
}

std::optional<Result> withoutStrayViews(const Dataset& data, const Settings& settings, const Result* bad,
                                        const Fit& fit) {
  std::vector<Stray> suspects = viewsThatDisagree(data, settings);
  std::optional<Result> without;
  if (const Dataset rest = withoutViews(data, suspects);
      !suspects.empty() && suffices(rest, data) && mayBeBetter(data, suspects, settings, bad)) {
    without = fitted(fit, rest);
    if (without && !isBetter(*without, bad, settings)) without.reset();
  }
  // In a rig, views that contradict other cameras may have a wrong image number. If gross corners are not rejected, a
  // single one may spoil an image.
  const bool may_leave_out_worst = bad && !bad->images.empty() && settings.robust == Robust::reject &&
                                   (bad->strays.empty() || data.cameras.size() == 1);
  if (!without && may_leave_out_worst) {
    auto found = withoutWorst(data, settings, *bad);
    if (!found) return {};
    suspects = std::move(found->gone);
    if (isLong(data) && judged(suspects, data, found->result).empty()) return {};
    without = fitted(fit, withoutViews(data, suspects));
    if (without && !isBetter(*without, bad, settings)) without.reset();
  }
  if (!without) return {};
  std::vector<Stray> strays = judged(suspects, data, *without);
  if (strays.size() < suspects.size()) {
    std::optional<Result> with_some = strays.empty() ? std::nullopt : fitted(fit, withoutViews(data, strays));
    if (strays.empty() || !with_some || !isBetter(*with_some, bad, settings)) return {};
    without = std::move(with_some);
  }
  addScaledViews(data, settings, fit, *without, strays);
  strays = sortedByImage(std::move(strays));
  without->strays.insert(without->strays.end(), strays.begin(), strays.end());
  return without;
}

}  // namespace slom::calibration
