#include "calibration/procedure/scaled_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "calibration/cross_matrix.hpp"
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

/// Returns the RMS distance of the corners from their pixels for the best pose of the view, from a start [px]. Uses
/// Gauss-Newton with step control. An Estimator for each pose executes four times as many instructions, in every good
/// calibration.
double rmsOfBestPose(const Lens& lens, const View& view, double pixel_scale, SE3 world2camera, Look look) {
  const int steps = look == Look::quick ? 12 : 40;
  const double tolerance = look == Look::quick ? 1e-3 : 1e-9;
  const auto squares = [&](const SE3& pose) {
    double sum = 0;
    for (const Corner& corner : view.corners)
      sum += (lens.project(vec3(pose * corner.world)) - vec2(pixel_scale * corner.pixel)).squaredNorm();
    return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
  };
  double least = squares(world2camera), damping = 1e-4;
  for (int step = 0; step < steps && std::isfinite(least); ++step) {
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
    for (const Corner& corner : view.corners) {
      const vec3 point(world2camera * corner.world);
      const Lens::PointProjection at = lens.differentiate(point);
      const Eigen::Vector2d e = at.pixel - vec2(pixel_scale * corner.pixel);
      Eigen::Matrix<double, 2, 6> J;
      J << at.by_point, -at.by_point * crossMatrix(point);
      H += J.transpose() * J, g += J.transpose() * e;
    }
    H.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, 6, 1> d = -H.ldlt().solve(g);
    const SO3 turn = SO3::exp(vec3(Eigen::Vector3d(d.tail<3>())));
    const SE3 next(turn * world2camera.orient,
                   vec3(turn * world2camera.pos + vec3(Eigen::Vector3d(d.head<3>()))));
    const double sum = squares(next);
    if (sum < least) {
      const bool is_done = least - sum < tolerance * least;
      world2camera = next, least = sum, damping = std::max(1e-9, damping / 10);
      if (is_done) break;
    } else if ((damping *= 10) > 1e6) {
      break;
    }
  }
  return std::sqrt(least / double(view.corners.size()));
}

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
  for (const SE3& start : starts)
    least = std::min(least, rmsOfBestPose(lens, view, pixel_scale, start, look));
  return least / pixel_scale;
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

bool maybeOfAnotherSize(const Dataset& data, const Settings& settings, const Result& result) {
  constexpr std::size_t folds = 5, most_images = 80;
  const std::vector<int> images = data.images();
  if (images.size() < folds + 1 || images.size() > most_images) return false;
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

std::vector<Stray> viewsOfAnotherSize(Dataset data, const Settings& settings, const Result& result,
                                      const std::function<bool(const Dataset&)>& is_enough) {
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
