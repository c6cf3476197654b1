#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "calibration/fit/model_fit.hpp"
#include "calibration/initialization/parallel_views.hpp"
#include "calibration/initialization/view_misfit.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/procedure/stray_views.hpp"
#include "slom/calibration/assess.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double most_parallel = 8 * std::numbers::pi / 180;  // [rad]

/// Returns the largest angle between boards and their mean in any camera, for a rough focal length [rad].
double tiltsOfViews(const Dataset& data) {
  double largest = 0;
  for (const CameraData& camera : data.cameras) largest = std::max(largest, normalSpread(planeViews(camera)));
  return largest;
}

bool hasOpenFocalLengths(const Result& result) {
  return std::any_of(result.cameras.begin(), result.cameras.end(), [](const CameraResult& camera) {
    return camera.parameters.front().std > 0.2 * std::abs(camera.parameters.front().value);
  });
}

/// Returns every n-th image of a long recording: an obvious difference between models shows in these, too.
Dataset partOf(const Dataset& data) {
  constexpr std::size_t enough = 200;  // images
  const std::vector<int> images = data.images();
  const std::size_t step = images.size() / enough;
  if (step < 2) return data;
  Dataset part = data;
  for (CameraData& camera : part.cameras) {
    std::erase_if(camera.views, [&](const View& view) {
      const auto place = std::lower_bound(images.begin(), images.end(), view.image) - images.begin();
      return std::size_t(place) % step != 0;
    });
  }
  return part;
}

void lookForBetterModel(const Dataset& all, const Settings& settings, Result& result) {
  constexpr double obvious = 0.5;  // RMS with the other model over RMS with this one
  const Dataset data = partOf(all);
  const double rms = result.success() ? rmsOfAll(result) : unknown;
  for (const char* name : {"opencv5", "fisheye"}) {
    if (settings.model == Model(name) || !settings.lens.empty() || !reasonToEnd(settings.limits).empty())
      continue;
    Settings other = settings;
    other.model = Model(name);
    const ModelTrial trial = tryModel(data, other);
    if (!trial.failure.empty() || !(trial.rms_px < std::fmin(obvious * rms, 8 * settings.sigma_px + 1)))
      continue;
    if (result.better_model && result.better_model->rms_px <= trial.rms_px) continue;
    result.better_model = BetterModel{name, trial.rms_px};
  }
}

/// Returns a clause with the usual causes that each image by itself excludes.
std::string excludedCauses(const Dataset& data, double tilts) {
  std::vector<double> distances;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) distances.push_back(misfitOf(view).px);
  }
  return fmt::format(
      "no usual cause is found: the corners of each image are consistent to {} px, and boards are tilted "
      "by up to {:.0f} degrees from their mean; look at the worst images, and try a model with fewer "
      "parameters",
      twoDigits(medianOf(distances)), tilts * 180 / std::numbers::pi);
}

/// Returns a clause with the corner that contradicts the others most, and the number of further ones.
std::string grossCause(const Result& result) {
  const GrossCorner& worst = *std::max_element(
      result.gross.begin(), result.gross.end(),
      [](const GrossCorner& a, const GrossCorner& b) { return a.error_without_px < b.error_without_px; });
  const std::size_t more = result.gross.size() - 1;
  return fmt::format("corner {} of image {} of {} is {} px from where the others put it{}; leave it out",
                     worst.number, worst.image, result.cameras[worst.camera].name,
                     twoDigits(worst.error_without_px),
                     more == 0 ? "" : fmt::format(", and {} more corners are far off", more));
}

/// Returns the data with the corners of one camera counted from another end of the board: turned by quarters in its
/// plane, about its centre. Returns nothing if the turned board looks different.
std::optional<Dataset> turned(const Dataset& data, std::size_t c, int quarters) {
  const SE3 board2world = outlineOf(fullestView(data)).board2world;
  const SE3 turn =
      board2world * SE3(SO3::exp(vec3(0., 0., quarters * std::numbers::pi / 2))) * board2world.inverse();
  using Key = std::tuple<long, long, long>;
  const BoardOutline outline = outlineOf(fullestView(data));
  const double unit = 1e-4 * std::max(outline.width, outline.height);
  const auto keyOfPoint = [&](const vec3& p) {
    return Key(std::lround(p.x() / unit), std::lround(p.y() / unit), std::lround(p.z() / unit));
  };
  std::vector<vec3> points;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      for (const Corner& corner : view.corners) points.push_back(corner.world);
    }
  }
  std::set<Key> known;
  for (const vec3& p : points) known.insert(keyOfPoint(p));
  const auto isKnown = [&](const vec3& p) {
    const auto [x, y, z] = keyOfPoint(p);
    for (long i = -1; i <= 1; ++i) {
      for (long j = -1; j <= 1; ++j) {
        for (long k = -1; k <= 1; ++k) {
          if (known.contains({x + i, y + j, z + k})) return true;
        }
      }
    }
    return false;
  };
  Dataset result = data;
  for (View& view : result.cameras[c].views) {
    for (Corner& corner : view.corners) {
      corner.world = turn * corner.world;
      if (!isKnown(corner.world)) return {};  // the turned board looks different
    }
  }
  return result;
}

}  // namespace

void nameCauses(const Dataset& data, const Settings& settings, Result& result) {
  constexpr int few_iterations = 50;  // a lower limit of iterations says nothing about the data
  if (!result.success() && result.undetermined.empty() && settings.max_iterations < few_iterations) return;
  const double tilts = tiltsOfViews(data);
  const bool is_open = !result.success() || hasOpenFocalLengths(result);
  if (is_open && tilts < most_parallel) {
    if (result.undetermined.empty() || result.undetermined.find("same tilt") == std::string::npos)
      result.declareUndetermined(fmt::format(
          "all {} images show the board at nearly the same tilt, within {:.2g} degrees, which leaves "
          "the focal length open; tilt the board by 30 degrees, about both axes",
          data.images().size(), std::max(0.1, tilts * 180 / std::numbers::pi)));
    result.causes.push_back(result.undetermined);
    return;
  }
  if (!isBadFit(result, settings)) return;
  lookForBetterModel(data, settings, result);
  if (result.better_model || !reasonToEnd(settings.limits).empty()) return;
  result.causes.push_back(result.gross.empty() ? excludedCauses(data, tilts) : grossCause(result));
}

void nameOtherEnd(const Dataset& data, const Fit& fit, Result& result) {
  for (std::size_t c = 0; c < data.cameras.size() && data.cameras.size() > 1; ++c) {
    const std::string& name = data.cameras[c].name;
    const auto isOwn = [&](const Stray& stray) { return stray.camera == name; };
    const auto own = std::count_if(result.strays.begin(), result.strays.end(), isOwn);
    if (2 * std::size_t(own) <= data.cameras[c].views.size()) continue;
    for (const int quarters : {2, 1, 3}) {
      const auto other = turned(data, c, quarters);
      if (!other) continue;
      std::optional<Result> found;
      try {
        found = fit(*other);
      } catch (const slom::Error&) {
        continue;
      }
      if (!found->success() || std::any_of(found->strays.begin(), found->strays.end(), isOwn)) continue;
      for (Stray& stray : result.strays) {
        if (isOwn(stray))
          stray.why = fmt::format(
              "corners are counted from another end of the board: turned by {} degrees, they fit to {} px",
              90 * quarters, twoDigits(found->cameras[c].rms_px));
      }
      return;
    }
  }
}

}  // namespace slom::calibration
