#include "calibration/quality/verdict/next_best_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "calibration/limits.hpp"
#include "calibration/quality/uncertainty/variance_bound.hpp"
#include "slom/calibration/board.hpp"

namespace slom::calibration {
namespace {

constexpr double tilt = 40;  // degrees

struct Candidate {
  FurtherView view;
  Information information;
};

/// An attitude of the board: facing the camera, its upper edge up, turned by the tilt about an axis in the image.
struct Attitude {
  const char* edge_away;
  vec3 rotation;  ///< in the camera's axes [rad]
};
const std::array<Attitude, 5>& attitudes() {
  constexpr double a = tilt * std::numbers::pi / 180;
  static const std::array<Attitude, 5> all{{{"", vec3(0., 0., 0.)},
                                            {"right", vec3(0., -a, 0.)},
                                            {"left", vec3(0., a, 0.)},
                                            {"upper", vec3(-a, 0., 0.)},
                                            {"lower", vec3(a, 0., 0.)}}};
  return all;
}

/// The board with its normal towards the cameras, and its corners in the world.
struct Target {
  SE3 board2world;
  std::vector<vec3> corners;
};
Target targetOf(const View& view, const SE3& some_left2world) {
  Target board{outlineOf(view).board2world, {}};
  for (const Corner& corner : view.corners) board.corners.push_back(corner.world);
  const SE3 camera_in_board = board.board2world.inverse() * some_left2world;
  if (camera_in_board.pos.z() < 0)
    board.board2world = board.board2world * SE3(SO3::exp(vec3(std::numbers::pi, 0., 0.)));
  return board;
}

/// Returns left2world for a board whose centre is at `centre` before camera c. Before the tilt, its normal points
/// against the camera's z axis, and its longer side points right.
SE3 placed(const FittedRig& rig, std::size_t c, const Target& board, const vec3& centre,
           const Attitude& attitude) {
  const SO3 facing = SO3::exp(vec3(std::numbers::pi, 0., 0.));
  const SE3 board2camera(SO3::exp(attitude.rotation) * facing, centre);
  return board.board2world * board2camera.inverse() * rig.left2camera[c];
}

/// The part of space that a camera sees. The angle is limited, because a distortion polynomial that folds back also
/// projects points outside all rays into the image.
struct FieldOfView {
  ImageBox box;
  double least_cosine = 1;  ///< cosine of the largest angle between a ray of the image and the optical axis

  bool holds(const Lens& lens, const vec3& point) const {
    if (!(point.z() > least_cosine * point.norm())) return false;
    const vec2 pixel = lens.project(point);
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < box.width && pixel.y() < box.height;
  }
};

std::vector<FieldOfView> fieldsOfView(const FittedRig& rig, const std::vector<ImageGrid>& grids) {
  std::vector<FieldOfView> fields;
  for (std::size_t c = 0; c < grids.size(); ++c) {
    fields.push_back({grids[c].box});
    for (const auto& ray : raysOf(rig.lenses[c], grids[c])) {
      if (ray) fields.back().least_cosine = std::min(fields.back().least_cosine, ray->z());
    }
  }
  return fields;
}

/// Returns the part of the board that the cameras would see.
Observation observationOf(const FittedRig& rig, const std::vector<FieldOfView>& fields,
                          const std::vector<vec3>& board, const SE3& left2world) {
  constexpr std::size_t fewest = 4;  // needed for a pose
  Observation observation{left2world, std::vector<std::vector<Corner>>(rig.lenses.size()), {}};
  for (std::size_t c = 0; c < rig.lenses.size(); ++c) {
    const SE3 world2camera = rig.left2camera[c] * left2world.inverse();
    const Eigen::Matrix3d R = world2camera.orient.toRotationMatrix();
    std::vector<Corner>& corners = observation.corners[c];
    corners.reserve(board.size());
    for (const vec3& corner : board) {
      if (fields[c].holds(rig.lenses[c], vec3(R * corner + world2camera.pos)))
        corners.push_back({0, corner, {}});
    }
    if (corners.size() < fewest) corners.clear();
  }
  return observation;
}

/// Adds candidates: boards of which the camera sees two thirds or more.
void addCandidates(const FittedRig& rig, const std::vector<FieldOfView>& fields, const Target& board,
                   std::size_t c, double distance_m, std::vector<Candidate>& candidates) {
  constexpr int places = 3;
  const ImageBox& box = fields[c].box;
  for (int place = 0; place < places * places; ++place) {
    const int column = place % places, row = place / places;
    const vec2 pixel(box.width * (0.16 + 0.34 * column), box.height * (0.16 + 0.34 * row));
    const auto ray = rig.lenses[c].unproject(pixel);
    if (!ray) continue;
    for (const Attitude& attitude : attitudes()) {
      const SE3 left2world = placed(rig, c, board, vec3(distance_m * *ray), attitude);
      const Observation observation = observationOf(rig, fields, board.corners, left2world);
      if (3 * observation.corners[c].size() < 2 * board.corners.size()) continue;
      FurtherView view;
      view.camera = c;
      view.pixel = pixel;
      view.column = column;
      view.row = row;
      view.tilt_deg = *attitude.edge_away ? tilt : 0;
      view.edge_away = attitude.edge_away;
      view.distance_m = distance_m;
      view.left2world = left2world;
      candidates.push_back({view, informationOf(rig, observation)});
    }
  }
}

/// Returns the points in a few parts, the most uncertain first. Nearly all candidates are worse than the best so far
/// already in the first part.
std::vector<ProjectedPoints> inParts(const ProjectedPoints& points, const std::vector<double>& std) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return std[a] > std[b]; });
  std::vector<ProjectedPoints> parts;
  for (std::size_t first = 0, size = 4; first < order.size(); first += size, size *= 2) {
    const std::size_t last = std::min(first + size, order.size());
    parts.push_back(points.at({order.begin() + std::ptrdiff_t(first), order.begin() + std::ptrdiff_t(last)}));
  }
  return parts;
}

struct WorstPoint {
  double std = 0;
  DirectedPoint point{};
};

/// Returns the point with the largest standard deviation. Ends early at a point whose standard deviation reaches
/// `limit`.
WorstPoint worstPoint(const std::vector<ProjectedPoints>& parts, const Posterior& posterior, double limit) {
  WorstPoint worst;
  for (const ProjectedPoints& part : parts) {
    const std::vector<double> std = part.std(posterior);
    const auto largest = std::max_element(std.begin(), std.end());
    if (*largest > worst.std)
      worst = {*largest, part.alongLargest(std::size_t(largest - std.begin()), posterior)};
    if (!(worst.std < limit)) break;
  }
  return worst;
}

/// The best candidate and the worst standard deviation with it; no candidate if none is below `before`.
struct Choice {
  const Candidate* candidate = nullptr;
  double after = 0;
};

/// Tries the candidates by ascending lower bounds of the worst standard deviation. Points that remain uncertain with
/// one candidate are uncertain with others, too: each adds a bound.
Choice bestOf(const std::vector<Candidate>& candidates, const Information& so_far,
              const std::vector<ProjectedPoints>& parts, double before, const Limits& limits) {
  constexpr std::size_t most_bounds = 8;  // more cost more than they save
  std::vector<VarianceBound> bounds;
  const auto addBound = [&](const WorstPoint& worst, const Posterior& posterior) {
    if (bounds.size() < most_bounds && worst.std > 0)
      bounds.emplace_back(worst.point.by_shared, worst.point.by_motion, posterior);
  };
  const Posterior known(so_far);
  addBound(worstPoint(parts, known, 0), known);
  Information with = so_far;
  std::vector<std::pair<double, const Candidate*>> order;
  for (const Candidate& candidate : candidates) {
    requireTime(limits);
    with.setSum(so_far, candidate.information);
    order.emplace_back(bounds.empty() ? 0 : bounds.front().of(with), &candidate);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });

  Choice best{nullptr, before};
  for (const auto& [bound, candidate] : order) {
    requireTime(limits);
    const double least_variance = best.after * best.after;
    if (bound >= least_variance) break;
    with.setSum(so_far, candidate->information);
    if (std::any_of(bounds.rbegin(), bounds.rend(),
                    [&](const VarianceBound& b) { return b.of(with) >= least_variance; }))
      continue;
    const Posterior posterior(with);
    const WorstPoint worst = worstPoint(parts, posterior, best.after);
    if (worst.std < best.after) best = {candidate, worst.std};
    addBound(worst, posterior);
  }
  return best;
}

}  // namespace

ProjectedPoints pointsOfAllCameras(const FittedRig& rig, const std::vector<ImageGrid>& grids,
                                   double distance_m) {
  std::vector<ProjectedPoint> points;
  for (std::size_t c = 0; c < grids.size(); ++c) {
    for (const auto& ray : raysOf(rig.lenses[c], grids[c])) {
      if (ray) points.push_back(projectedPoint(rig, c, *ray, distance_m));
    }
  }
  return ProjectedPoints(points);
}

double worstStd(const ProjectedPoints& points, const Posterior& posterior) {
  const std::vector<double> all = points.std(posterior);
  return all.empty() ? 0 : *std::max_element(all.begin(), all.end());
}

std::vector<FurtherView> furtherViews(const FittedRig& rig, const Information& information, const View& view,
                                      const std::vector<ImageGrid>& grids,
                                      const FurtherViewOptions& options) {
  const Target board = targetOf(view, rig.left2world.at(view.image));
  std::vector<ImageGrid> coarse = grids;
  for (ImageGrid& grid : coarse) grid.columns = options.grid_columns, grid.rows = options.grid_rows;
  const double of_distance_m = options.of_distance_m.value_or(options.board_distance_m);
  const ProjectedPoints points = pointsOfAllCameras(rig, coarse, of_distance_m);

  const std::vector<FieldOfView> fields = fieldsOfView(rig, coarse);
  std::vector<Candidate> candidates;
  for (std::size_t c = 0; c < grids.size(); ++c) {
    for (const double nearer : {1.0, 0.6}) {
      requireTime(options.limits);
      addCandidates(rig, fields, board, c, nearer * options.board_distance_m, candidates);
    }
  }

  Information so_far = information;
  std::vector<FurtherView> best_ones;
  for (int k = 0; k < options.count; ++k) {
    const std::vector<double> now = points.std(Posterior(so_far));
    if (now.empty()) break;
    const double before = *std::max_element(now.begin(), now.end());
    const std::vector<ProjectedPoints> parts = inParts(points, now);
    const Choice best = bestOf(candidates, so_far, parts, before, options.limits);
    if (!best.candidate) break;
    so_far.add(best.candidate->information);
    best_ones.push_back(best.candidate->view);
    best_ones.back().before_px = best_ones.size() == 1 ? before : best_ones[best_ones.size() - 2].after_px;
    best_ones.back().after_px = best.after;
    best_ones.back().of_distance_m = of_distance_m;
  }
  return best_ones;
}

}  // namespace slom::calibration
