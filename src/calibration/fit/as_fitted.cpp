#include "calibration/fit/as_fitted.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/image_box.hpp"
#include "calibration/data/view_facts.hpp"
#include "calibration/median.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/board.hpp"

namespace slom::calibration {

double CornerNoise::at(double x) const {
  const double ratio = std::isfinite(x) ? x / typical : 1;
  return factor * std::sqrt(1 + growth * ratio * ratio);
}

namespace {

/// Scales of the losses, applied to the distance of a corner, divided by its standard deviation in each coordinate.
/// With normal noise in two coordinates, the efficiency is 95 %.
constexpr double huber_scale = 1.5, cauchy_scale = 2.55;

Loss lossOf(const Downweighted& down) {
  return down.loss == Huber(huber_scale).text() ? Loss(Huber(huber_scale)) : Loss(Cauchy(cauchy_scale));
}

Eigen::Vector3d normalOf(const Dataset& data) {
  return fitPlane(fullestView(data).corners).plane2world.orient.toRotationMatrix().col(2);
}

}  // namespace

Loss lossOf(Robust robust) {
  if (robust == Robust::huber) return Huber(huber_scale);
  if (robust == Robust::cauchy) return Cauchy(cauchy_scale);
  return {};
}

std::vector<double> quantityOf(SigmaBy by, const Dataset& on_board, const Result& result, std::size_t c) {
  const CameraData& camera = on_board.cameras[c];
  std::vector<double> x;
  if (by == SigmaBy::speed) {
    for (const ViewMotion& motion : motionsOf(camera)) x.push_back(motion.speed);
    return x;
  }
  const std::map<int, SE3> left2world = posesOf(result);
  const Eigen::Vector3d normal = normalOf(on_board);
  for (const View& view : camera.views) {
    const auto pose = left2world.find(view.image);
    if (by == SigmaBy::constant || pose == left2world.end()) {
      x.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const ViewGeometry seen =
        geometryOf(view, result.cameras[c].left2camera * pose->second.inverse(), normal);
    x.push_back(by == SigmaBy::slant ? seen.slant : seen.distance);
  }
  return x;
}

std::map<int, SE3> posesOf(const Result& result) {
  std::map<int, SE3> poses;
  for (const ImageResult& image : result.images) poses.emplace(image.image, image.left2world);
  return poses;
}

std::vector<double> distancesOf(const View& view, const CameraResult& camera, const SE3& left2world) {
  const SE3 world2camera = camera.left2camera * left2world.inverse();
  const Lens lens = lensOf(camera);
  std::vector<double> distances;
  for (const Corner& corner : view.corners)
    distances.push_back((lens.project(vec3(world2camera * corner.world)) - corner.pixel).norm());
  return distances;
}

void applyGrowth(const Result& result, const Dataset& on_board, Dataset& data) {
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const CornerNoise& noise = result.cameras[c].noise;
    if (noise.growth == 0) continue;
    const std::vector<double> x = quantityOf(noise.by, on_board, result, c);
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (Corner& corner : data.cameras[c].views[i].corners) corner.sigma *= noise.at(x[i]);
    }
  }
}

void applyLoss(const Loss& loss, const Result& result, const Dataset& on_board, Dataset& data,
               Downweighted& down) {
  const std::map<int, SE3> poses = posesOf(result);
  double weights = 0, curvatures = 0, count = 0;
  down.corners = 0, down.least = 1;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (std::size_t v = 0; v < data.cameras[c].views.size(); ++v) {
      const View& view = on_board.cameras[c].views[v];
      const auto pose = poses.find(view.image);
      if (pose == poses.end()) continue;  // the fit failed early
      const std::vector<double> distances = distancesOf(view, result.cameras[c], pose->second);
      for (std::size_t k = 0; k < distances.size(); ++k) {
        Corner& corner = data.cameras[c].views[v].corners[k];
        const double length = distances[k] / (down.noise_px * corner.sigma), s = length * length;
        if (!std::isfinite(s)) continue;
        const LossValue value = loss.evaluate(s);
        corner.sigma /= std::sqrt(value.first);
        weights += value.first, count += 1;
        curvatures += value.first + value.second * s;  // half the trace of the second derivative
        down.corners += value.first < 0.5 ? 1 : 0;
        down.least = std::min(down.least, value.first);
      }
    }
  }
  if (!(count > 0)) return;
  down.mean = weights / count;
  down.over_curvature = curvatures > 0 ? std::max(1.0, weights / curvatures) : 1;
}

std::vector<std::vector<Eigen::Vector2d>> motionsByPoses(const CameraData& camera, const CameraResult& fitted,
                                                         const Result& result) {
  std::map<int, SE3> world2camera;
  std::vector<double> gaps;
  for (const ImageResult& image : result.images) {
    if (!world2camera.empty()) gaps.push_back(image.image - world2camera.rbegin()->first);
    world2camera.emplace(image.image, fitted.left2camera * image.left2world.inverse());
  }
  const double most = 2 * medianOf(gaps);
  const Lens lens = lensOf(fitted);
  std::vector<std::vector<Eigen::Vector2d>> motions;
  for (const View& view : camera.views) {
    motions.emplace_back();
    const auto here = world2camera.find(view.image);
    if (here == world2camera.end()) {
      motions.back().assign(view.corners.size(), Eigen::Vector2d::Constant(unknown));
      continue;
    }
    const bool has_before = here != world2camera.begin() && here->first - std::prev(here)->first <= most;
    const bool has_after =
        std::next(here) != world2camera.end() && std::next(here)->first - here->first <= most;
    const auto first = has_before ? std::prev(here) : here, last = has_after ? std::next(here) : here;
    for (const Corner& corner : view.corners) {
      const auto at = [&](const SE3& pose) {
        return Eigen::Vector2d(lens.project(vec3(pose * corner.world)));
      };
      motions.back().push_back((at(last->second) - at(first->second)) / double(last->first - first->first));
    }
  }
  return motions;
}

Dataset withNoiseOf(const Result& result, const Dataset& data) {
  Dataset weighted = data;
  const DataOnBoard on_board(data, result.board);
  applyGrowth(result, *on_board, weighted);
  if (!result.downweighted) return weighted;
  Downweighted again = *result.downweighted;
  applyLoss(lossOf(again), result, *on_board, weighted, again);
  return weighted;
}

Dataset withMotion(const Result& result, const Dataset& data) {
  Dataset moving = data;
  const DataOnBoard on_board(data, result.board);
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const double height = imageBoxOf(data.cameras[c], result.cameras[c]).height;
    const auto motions = motionsByPoses((*on_board).cameras[c], result.cameras[c], result);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      for (std::size_t k = 0; k < motions[i].size(); ++k) {
        Corner& corner = moving.cameras[c].views[i].corners[k];
        corner.by_readout =
            motions[i][k].allFinite() ? vec2(corner.pixel.y() / height * motions[i][k]) : vec2();
      }
    }
  }
  return moving;
}

bool moves(const CameraData& camera) {
  return std::any_of(camera.views.begin(), camera.views.end(), [](const View& view) {
    return std::any_of(view.corners.begin(), view.corners.end(),
                       [](const Corner& corner) { return corner.by_readout.squaredNorm() > 0; });
  });
}

Dataset withoutReadout(const Dataset& data, const Result& result) {
  if (std::none_of(result.cameras.begin(), result.cameras.end(), [](const auto& c) { return c.readout; }))
    return data;
  Dataset still = withMotion(result, data);
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    if (!result.cameras[c].readout) continue;
    for (View& view : still.cameras[c].views) {
      for (Corner& corner : view.corners)
        corner.pixel -= result.cameras[c].readout->value * corner.by_readout;
    }
  }
  return still;
}

Dataset asFitted(const Result& result, const Dataset& data) {
  return withNoiseOf(result, withoutReadout(data, result));
}

}  // namespace slom::calibration
