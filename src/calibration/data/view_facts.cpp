#include "calibration/data/view_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "calibration/data/point_key.hpp"
#include "calibration/median.hpp"

namespace slom::calibration {
namespace {

/// The pixel of a corner in a neighbouring view; NaN if the view does not have the corner.
struct Neighbour {
  Eigen::Vector2d pixel = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  double image = 0;
};

/// Returns, for the corners of all views, their pixels in the view before or in the view after.
std::vector<std::vector<Neighbour>> neighboursOf(const CameraData& camera, bool is_before, double most_gap) {
  const std::size_t views = camera.views.size();
  std::vector<std::vector<Neighbour>> neighbours(views);
  std::map<PointKey, Eigen::Vector2d> seen;  // in the view of the previous round
  for (std::size_t k = 0; k < views; ++k) {
    const std::size_t i = is_before ? k : views - 1 - k, neighbour = is_before ? i - 1 : i + 1;
    const View& view = camera.views[i];
    const bool is_near = k > 0 && std::abs(view.image - camera.views[neighbour].image) <= most_gap;
    std::map<PointKey, Eigen::Vector2d> own;
    for (const Corner& corner : view.corners) {
      const PointKey key = keyOf(corner.world);
      neighbours[i].emplace_back();
      const auto at = is_near ? seen.find(key) : seen.end();
      if (at != seen.end()) neighbours[i].back() = {at->second, double(camera.views[neighbour].image)};
      own.emplace(key, corner.pixel);
    }
    seen = std::move(own);
  }
  return neighbours;
}

}  // namespace

std::vector<ViewMotion> motionsOf(const CameraData& camera) {
  const std::size_t views = camera.views.size();
  std::vector<double> gaps;
  for (std::size_t i = 1; i < views; ++i) gaps.push_back(camera.views[i].image - camera.views[i - 1].image);
  const double most = 2 * medianOf(gaps);
  const auto before = neighboursOf(camera, true, most), after = neighboursOf(camera, false, most);
  std::vector<ViewMotion> motions(views);
  for (std::size_t i = 0; i < views; ++i) {
    const View& view = camera.views[i];
    std::vector<double> speeds;
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      const Neighbour here{view.corners[k].pixel, double(view.image)};
      const Neighbour& first = before[i][k].pixel.allFinite() ? before[i][k] : here;
      const Neighbour& last = after[i][k].pixel.allFinite() ? after[i][k] : here;
      motions[i].of_corners.emplace_back((last.pixel - first.pixel) / (last.image - first.image));
      if (motions[i].of_corners.back().allFinite()) speeds.push_back(motions[i].of_corners.back().norm());
    }
    motions[i].speed = speeds.empty() ? std::numeric_limits<double>::quiet_NaN() : medianOf(speeds);
  }
  return motions;
}

ViewGeometry geometryOf(const View& view, const SE3& world2camera, const Eigen::Vector3d& normal) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Corner& corner : view.corners)
    centre += world2camera * corner.world / double(view.corners.size());
  const Eigen::Vector3d in_camera = world2camera.orient.toRotationMatrix() * normal;
  return {std::acos(std::min(1.0, std::abs(in_camera.dot(centre)) / centre.norm())), centre.norm()};
}

}  // namespace slom::calibration
