#include "calibration/fit/stray_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "calibration/cross_matrix.hpp"
#include "calibration/data/check.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/initialization/view_misfit.hpp"
#include "calibration/initialization/view_pose.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/quality/lens.hpp"
#include "slom/calibration/assess.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double least_bad_px = 1, bad_sigmas = 4;  // RMS beyond which another look is worth it
constexpr double much_worse_view = 3.5;             // RMS of a view over the median of its camera
constexpr double much_better = 0.5;                 // RMS of all without the strays over that with them

double explainedPx(const Settings& settings) {
  return std::max(least_bad_px, bad_sigmas * settings.sigma_px);
}

struct ViewRms {
  Stray view;
  double over_median;
};

/// The views of all cameras, the worst first.
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

std::size_t countViews(const Dataset& data) {
  std::size_t count = 0;
  for (const CameraData& camera : data.cameras) count += camera.views.size();
  return count;
}

/// Whether enough views of each camera are left, connected as before.
bool suffices(const Dataset& rest, const Dataset& all) {
  for (std::size_t c = 0; c < rest.cameras.size(); ++c) {
    const std::size_t left = rest.cameras[c].views.size();
    if (left < 3 || 3 * left < 2 * all.cameras[c].views.size()) return false;
  }
  if (rest.imu && rest.imu->readings.empty()) return false;
  try {
    checkConnected(rest);
  } catch (const DataError&) {
    return false;
  }
  return true;
}

/// Views whose corners disagree among themselves: far off any smooth map, and much farther than those of other views of their camera.
std::vector<Stray> viewsThatDisagree(const Dataset& data, const Settings& settings) {
  constexpr double least_part = 0.005, over_median = 4;
  std::vector<Stray> found;
  for (const CameraData& camera : data.cameras) {
    std::vector<ViewMisfit> misfits;
    std::vector<double> parts, distances;
    for (const View& view : camera.views) {
      misfits.push_back(misfitOf(view));
      parts.push_back(misfits.back().part());
      distances.push_back(misfits.back().px);
    }
    const double usual = medianOf(parts), usual_px = medianOf(distances);
    for (std::size_t i = 0; i < misfits.size(); ++i) {
      if (misfits[i].part() < std::max(least_part, over_median * usual) ||
          misfits[i].px < 2 * settings.sigma_px)
        continue;
      found.push_back(
          {camera.name, camera.views[i].image, misfits[i].px, camera.views[i].photo, true,
           fmt::format(
               "its corners disagree among themselves, by {} px where those of other images do by {} px",
               twoDigits(misfits[i].px), twoDigits(usual_px))});
    }
  }
  return found;
}

/// The RMS distance of the corners from their pixels for the best pose of the view, from a start [px]: Gauss-Newton with step control.
double rmsOfBestPose(const Lens& lens, const View& view, double pixel_scale, SE3 world2camera) {
  constexpr int steps = 40;
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
      const Lens::PointProjection at = lens.differentiateByPoint(point);
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
      const bool is_done = least - sum < 1e-9 * least;
      world2camera = next, least = sum, damping = std::max(1e-9, damping / 10);
      if (is_done) break;
    } else if ((damping *= 10) > 1e6) {
      break;
    }
  }
  return std::sqrt(least / double(view.corners.size()));
}

/// By the poses of the boards in the other images, and by that of a homography as starts.
double rmsOfBestPose(const Result& result, std::size_t c, const View& view, double pixel_scale) {
  constexpr std::size_t most_starts = 12;
  const CameraResult& camera = result.cameras[c];
  const std::unique_ptr<Lens> lens = makeLens(camera);
  View scaled = view;
  for (Corner& corner : scaled.corners) corner.pixel *= pixel_scale;
  const PlaneView plane(scaled);
  const Eigen::Matrix3d& K = camera.camera_matrix;
  const Pinhole pinhole{K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
  const SE3 rough = poseFromHomography(plane, pinhole);
  std::vector<SE3> starts{rough, tiltedOtherWay(plane, rough)};
  const std::size_t step = 1 + result.images.size() / most_starts;
  for (std::size_t i = 0; i < result.images.size(); i += step)
    starts.push_back(camera.left2camera * result.images[i].left2world.inverse());
  double least = std::numeric_limits<double>::infinity();
  for (const SE3& start : starts) least = std::min(least, rmsOfBestPose(*lens, view, pixel_scale, start));
  return least / pixel_scale;
}

std::size_t indexOf(const Result& result, const std::string& camera) {
  return std::size_t(std::find_if(result.cameras.begin(), result.cameras.end(),
                                  [&](const CameraResult& one) { return one.name == camera; }) -
                     result.cameras.begin());
}

double usualRms(const Result& result, std::size_t c) {
  std::vector<double> all;
  for (const ImageResult& image : result.images) {
    if (image.rms_px[c]) all.push_back(*image.rms_px[c]);
  }
  return medianOf(all);
}

/// Those of the views that no pose fits, with the cause where it is known.
std::vector<Stray> judged(const std::vector<Stray>& views, const Dataset& data, const Result& result) {
  std::vector<Stray> strays;
  for (Stray stray : views) {
    const std::size_t c = indexOf(result, stray.camera);
    const View& view = *data.cameras[c].find(stray.image);
    const double usual = std::max(usualRms(result, c), 1e-3), limit = 3 * usual;
    stray.error_px = rmsOfBestPose(result, c, view, 1);
    if (stray.error_px <= limit) continue;
    stray.is_left_out = true;
    stray.photo = view.photo;
    for (const double scale : {2.0, 0.5, 4.0, 0.25}) {
      const double error = rmsOfBestPose(result, c, view, scale);
      if (!(error <= std::max(1.0, scale) * limit) || !(error < 0.5 * stray.error_px)) continue;
      stray.why = fmt::format(
          "it is of an image of {} times the size of the others, at which its corners fit to {} px",
          1 / scale, twoDigits(error));
      break;
    }
    strays.push_back(std::move(stray));
  }
  return strays;
}

/// Whether the fit without them is that much better.
bool isBetter(const Result& without, const Result* bad, const Settings& settings) {
  if (!without.success() || !without.strays.empty()) return false;
  if (!bad || !bad->success() || !bad->strays.empty()) return rmsOfAll(without) < explainedPx(settings);
  return rmsOfAll(without) < much_better * rmsOfAll(*bad) || !isBadFit(without, settings);
}

struct WithoutWorst {
  Result result;
  std::vector<Stray> gone;
};

/// Leaves out the worst view again and again, until the fit is not bad any more and the next one changes little.
std::optional<WithoutWorst> withoutWorst(const Dataset& data, const Settings& settings, const Result& bad) {
  constexpr std::size_t most_tried = 12;
  constexpr double little = 0.8;    // RMS over that with one view more
  constexpr double suspicious = 2;  // RMS of the view over the median of its camera
  WithoutWorst current{bad, {}};
  std::optional<WithoutWorst> good;
  while (current.gone.size() < std::min(most_tried, countViews(data) / 3)) {
    if (!reasonToEnd(settings.limits).empty()) break;
    const std::vector<ViewRms> views = viewsByRms(current.result);
    if (views.empty() || (good && views.front().over_median < suspicious)) break;
    current.gone.push_back(views.front().view);
    Dataset rest = withoutViews(data, current.gone);
    if (!suffices(rest, data)) break;
    rest.imu.reset();
    try {
      current.result = settings.model.definition().calibrate_from(current.result, rest, settings);
    } catch (const slom::Error&) {
      break;
    }
    if (isBadFit(current.result, settings)) continue;
    if (good && rmsOfAll(current.result) > little * rmsOfAll(good->result)) break;
    good = current;
  }
  return good;
}

std::optional<Result> fitted(const Fit& fit, const Dataset& data) {
  try {
    return fit(data);
  } catch (const slom::Error&) {  // no start values without them either
    return {};
  }
}

}  // namespace

bool isBadFit(const Result& result, const Settings& settings) {
  if (!result.success()) return true;
  const double explained = explainedPx(settings);
  if (rmsOfAll(result) > explained) return true;
  const std::vector<ViewRms> views = viewsByRms(result);
  return std::any_of(views.begin(), views.end(), [&](const ViewRms& one) {
    return one.view.error_px > explained && one.over_median > much_worse_view;
  });
}

std::optional<Result> withoutStrayViews(const Dataset& data, const Settings& settings, const Result* bad,
                                        const Fit& fit) {
  std::vector<Stray> suspects = viewsThatDisagree(data, settings);
  std::optional<Result> without;
  if (const Dataset rest = withoutViews(data, suspects); !suspects.empty() && suffices(rest, data)) {
    without = fitted(fit, rest);
    if (without && !isBetter(*without, bad, settings)) without.reset();
  }
  // Of a rig, views that contradict other cameras may have another image's number; where single gross corners count, an image may be bad by one of them.
  const bool may_leave_out_worst = bad && !bad->images.empty() && settings.robust == Robust::reject &&
                                   (bad->strays.empty() || data.cameras.size() == 1);
  if (!without && may_leave_out_worst) {
    auto found = withoutWorst(data, settings, *bad);
    if (!found) return {};
    suspects = std::move(found->gone);
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
  without->strays.insert(without->strays.end(), strays.begin(), strays.end());
  return without;
}

}  // namespace slom::calibration
