#include "calibration/procedure/scaled_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "calibration/data/check.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/fit/model_fit.hpp"
#include "calibration/fit/unfitted_views.hpp"
#include "calibration/initialization/view_pose.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double usual_ratios[] = {0.5, 2, 0.25, 4, 0.75, 4. / 3, 2. / 3, 1.5, 1. / 3, 3, 0.8, 1.25};
constexpr double fits_like_others = 1.15;  // RMS over the usual one, which is known to a tenth
constexpr double fits_hardly = 1.4;        // likewise, with a lens fitted to a part of the images
constexpr double least_gain = 30;          // of chi-square
constexpr std::size_t most_compared =
    80;  // images, each with a fit of the others; a fit of more hardly follows one

}  // namespace

double rmsOfBestPose(const Result& result, std::size_t c, const View& view, double pixel_scale, Look look) {
  constexpr std::size_t most_starts = 12;
  const CameraResult& camera = result.cameras[c];
  const Lens lens = lensOf(camera);
  View scaled = view;
  for (Corner& corner : scaled.corners) corner.pixel *= pixel_scale;
  const PlaneView plane(scaled);
  const Eigen::Matrix3d& K = camera.camera_matrix;
  const Pinhole pinhole{K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
  const SE3 rough = poseFromHomography(plane, pinhole);
  std::vector<SE3> starts{rough, tiltedOtherWay(plane, rough)};
  const std::size_t step = 1 + result.images.size() / most_starts;
  for (std::size_t i = 0; look == Look::careful && i < result.images.size(); i += step)
    starts.push_back(camera.left2camera * result.images[i].left2world.inverse());
  double least = std::numeric_limits<double>::infinity();
  for (const SE3& start : starts) least = std::min(least, fittedPose(lens, scaled, start, look).square);
  return std::sqrt(least / double(view.corners.size())) / pixel_scale;
}

std::size_t indexOf(const Result& result, const std::string& camera) {
  return std::size_t(std::find_if(result.cameras.begin(), result.cameras.end(),
                                  [&](const CameraResult& one) { return one.name == camera; }) -
                     result.cameras.begin());
}

std::optional<ImageScale> scaleOf(const Result& result, std::size_t c, const View& view, double preferred,
                                  Look look) {
  const double usual = std::max(usualRms(result, c), 1e-3);
  const double as_others = rmsOfBestPose(result, c, view, 1, look);
  if (as_others < (look == Look::quick ? fits_hardly : fits_like_others) * usual) return {};
  std::optional<ImageScale> best;
  const auto isFit = [&](const ImageScale& scale) {
    const double gain = double(view.corners.size()) * (as_others * as_others - scale.rms_px * scale.rms_px) /
                        (usual * usual / 2);
    return scale.rms_px < 2 * std::max(1.0, scale.size) * usual && scale.rms_px < 0.8 * as_others &&
           gain > least_gain;
  };
  for (const double size : usual_ratios) {
    const ImageScale scale{size, rmsOfBestPose(result, c, view, 1 / size, look)};
    if (isFit(scale) && (!best || scale.rms_px < best->rms_px)) best = scale;
  }
  if (best && preferred != 1 && preferred != best->size) {
    const ImageScale same{preferred, rmsOfBestPose(result, c, view, 1 / preferred, look)};
    if (isFit(same) && same.rms_px < 1.2 * best->rms_px) best = same;
  }
  return best;
}

namespace {

/// Returns views of images of another size among those that fit worse than the others of their camera. The first needs
/// more evidence than those after it; if the worst views are none, does not look at the rest.
std::vector<Stray> badViewsOfAnotherSize(const Dataset& data, const Result& result, bool is_first) {
  const double worse = is_first ? 2 : fits_hardly;  // RMS over the usual one
  const double better = is_first ? 0.4 : 1;         // RMS at another size over the RMS at that of the others
  constexpr std::size_t first_looked = 20;
  std::vector<Stray> found;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const std::string& name = data.cameras[c].name;
    const double usual = usualRms(result, c);
    std::vector<Stray> bad;
    for (const ImageResult& image : result.images) {
      if (image.rms_px[c] && *image.rms_px[c] > worse * usual)
        bad.push_back({name, image.image, *image.rms_px[c], {}, true});
    }
    std::stable_sort(bad.begin(), bad.end(),
                     [](const Stray& a, const Stray& b) { return a.error_px > b.error_px; });
    for (std::size_t i = 0; i < bad.size() && (i < first_looked || !is_first || !found.empty()); ++i) {
      const View* const view = data.cameras[c].find(bad[i].image);
      if (!view) continue;
      const auto scale = scaleOf(result, c, *view, found.empty() ? 1 : found.back().size, Look::quick);
      if (!scale || scale->rms_px > fits_like_others * std::max(1., scale->size) * usual ||
          scale->rms_px > better * rmsOfBestPose(result, c, *view, 1, Look::quick))
        continue;
      found.push_back(std::move(bad[i]));
      found.back().photo = view->photo, found.back().size = scale->size;
    }
  }
  return found;
}

}  // namespace

bool maybeOfAnotherSize(const Dataset& data, const Settings& settings, const Result& result) {
  constexpr std::size_t folds = 5;
  const std::vector<int> images = data.images();
  if (images.size() < folds + 1) return false;
  if (images.size() > most_compared) return true;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    if (!reasonToEnd(settings.limits).empty()) return false;
    const auto isHeldOut = [&](int image) {
      const auto at = std::lower_bound(images.begin(), images.end(), image);
      return std::size_t(at - images.begin()) % folds == fold;
    };
    Dataset rest = data.withImages([&](int image) { return !isHeldOut(image); });
    rest.imu.reset();
    try {
      checkConnected(rest);
      const Result without = calibrateModelFrom(result, rest, settings);
      if (!without.success()) continue;
      for (std::size_t c = 0; c < data.cameras.size(); ++c) {
        for (const View& view : data.cameras[c].views) {
          if (isHeldOut(view.image) && scaleOf(without, c, view, 1, Look::quick)) return true;
        }
      }
    } catch (const slom::Error&) {  // too few images are left
      continue;
    }
  }
  return false;
}

namespace {

void scaleView(Dataset& data, std::size_t c, int image, double factor) {
  for (View& view : data.cameras[c].views) {
    if (view.image != image) continue;
    for (Corner& corner : view.corners) corner.pixel *= factor;
  }
}

/// Returns the RSS of a fit from the beginning; infinity if it fails.
double rssOf(const Dataset& data, const Settings& settings) {
  try {
    const Result result = calibrateModel(data, settings, {});
    if (result.success() && result.strays.empty()) return result.rss;
  } catch (const slom::Error&) {
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<Stray> viewsToScale(Dataset data, Settings settings, double rss, std::size_t most_views) {
  constexpr double worth_it = 0.7;                              // RSS after scaling over RSS before
  constexpr std::size_t most_images = 20, most_corners = 4000;  // because each is tried in each round
  constexpr int enough_iterations = 30;
  std::vector<Stray> found;
  data.imu.reset();
  if (data.cameras.size() > 1 || data.cameras[0].views.size() > most_images ||
      data.cameras[0].cornerCount() > most_corners)
    return found;
  settings.max_iterations = std::min(settings.max_iterations, enough_iterations);
  while (found.size() < most_views) {
    std::optional<Stray> best;
    double least = worth_it * rss;
    for (std::size_t i = 0; i < data.cameras[0].views.size(); ++i) {
      const View view = data.cameras[0].views[i];
      for (const double size : {2., 0.5}) {
        if (!reasonToEnd(settings.limits).empty()) return {};
        scaleView(data, 0, view.image, 1 / size);
        if (const double now = rssOf(data, settings); now < least) {
          least = now;
          best = Stray{data.cameras[0].name, view.image, 0, view.photo, true};
          best->size = size;
        }
        data.cameras[0].views[i] = view;
      }
    }
    if (!best) break;
    rss = least;
    scaleView(data, 0, best->image, 1 / best->size);
    found.push_back(*best);
  }
  return found;
}

double gainOfScaling(Dataset data, const Settings& settings, const Result& with_all,
                     const std::vector<Stray>& views) {
  for (const Stray& stray : views)
    scaleView(data, indexOf(with_all, stray.camera), stray.image, 1 / stray.size);
  data.imu.reset();
  try {
    const Result scaled = calibrateModel(data, settings, {});
    if (!scaled.success() || !scaled.strays.empty()) return 0;
    const double noise = scaled.chi2PerDof();
    return noise > 0 ? (with_all.rss - scaled.rss) / noise : 0;
  } catch (const slom::Error&) {
    return 0;
  }
}

namespace {

/// Repeats after a fit without the views found, because the fit with them follows the others a little.
std::vector<Stray> viewsOfAnotherSizeAmongMany(Dataset data, const Settings& settings, const Result& result,
                                               bool is_first,
                                               const std::function<bool(const Dataset&)>& is_enough) {
  std::vector<Stray> found;
  Result current = result;
  data.imu.reset();
  while (reasonToEnd(settings.limits).empty()) {
    const std::vector<Stray> bad = badViewsOfAnotherSize(data, current, is_first && found.empty());
    data = withoutViews(data, bad);
    if (bad.empty() || !is_enough(data)) break;
    found.insert(found.end(), bad.begin(), bad.end());
    try {
      current = calibrateModelFrom(current, data, settings);
    } catch (const slom::Error&) {
      break;
    }
  }
  return found;
}

}  // namespace

std::vector<Stray> viewsOfAnotherSize(Dataset data, const Settings& settings, const Result& result,
                                      bool is_first, const std::function<bool(const Dataset&)>& is_enough) {
  if (data.images().size() > most_compared)
    return viewsOfAnotherSizeAmongMany(std::move(data), settings, result, is_first, is_enough);
  const Dataset all = data;
  std::vector<Stray> found;
  Result current = result;
  data.imu.reset();
  while (true) {
    std::optional<Stray> worst;
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      for (const View& view : data.cameras[c].views) {
        if (!reasonToEnd(settings.limits).empty()) return found;
        const Stray one{data.cameras[c].name, view.image, 0, view.photo, true};
        const Dataset others = withoutViews(data, {one});
        if (!is_enough(others)) return found;
        try {
          const Result without = calibrateModelFrom(current, others, settings);
          const auto scale = scaleOf(without, c, view, found.empty() ? 1 : found.back().size);
          if (!scale || !without.success()) continue;
          Stray stray = one;
          stray.error_px = rmsOfBestPose(without, c, view, 1), stray.size = scale->size;
          if (!worst || stray.error_px > worst->error_px) worst = std::move(stray);
        } catch (const slom::Error&) {
          continue;
        }
      }
    }
    if (!worst) return found;
    found.push_back(*worst);
    data = withoutViews(all, found);
    data.imu.reset();
    try {
      current = calibrateModelFrom(current, data, settings);
    } catch (const slom::Error&) {
      return found;
    }
  }
}

}  // namespace slom::calibration
