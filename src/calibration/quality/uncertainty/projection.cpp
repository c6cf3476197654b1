#include "calibration/quality/uncertainty/projection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/QR>

#include "calibration/cross_matrix.hpp"

namespace slom::calibration {
namespace {

/// Returns the standard deviation of each pixel in the direction in which it is largest. Columns 2i and 2i + 1 belong
/// to u and v of pixel i.
std::vector<double> largestStds(const Eigen::MatrixXd& whitened) {
  std::vector<double> result;
  for (Eigen::Index i = 0; i < whitened.cols(); i += 2) {
    const auto u = whitened.col(i), v = whitened.col(i + 1);
    result.push_back(largestStd(u.squaredNorm(), u.dot(v), v.squaredNorm()));
  }
  return result;
}

void summarise(const ImageGrid& grid, ProjectionUncertainty& map) {
  std::vector<double> known;
  std::copy_if(map.std_px.begin(), map.std_px.end(), std::back_inserter(known),
               [](double std) { return !std::isnan(std); });
  std::sort(known.begin(), known.end());
  map.middle_px = map.std_px[std::size_t(grid.middle())];
  map.median_px = known.empty() ? unknown : known[known.size() / 2];
  map.worst_px = known.empty() ? unknown : known.back();
}

}  // namespace

Eigen::Matrix2d ProjectedPoint::covariance(const Posterior& posterior) const {
  const Eigen::MatrixXd w = posterior.whitened(by_shared, by_motion);
  return w.transpose() * w;
}

ProjectedPoints::ProjectedPoints(const std::vector<ProjectedPoint>& points) {
  if (points.empty()) return;
  const auto rows = 2 * Eigen::Index(points.size());
  by_shared_.resize(rows, points.front().by_shared.cols());
  by_motion_.resize(rows, 6);
  for (std::size_t i = 0; i < points.size(); ++i) {
    by_shared_.middleRows<2>(2 * Eigen::Index(i)) = points[i].by_shared;
    by_motion_.middleRows<2>(2 * Eigen::Index(i)) = points[i].by_motion;
  }
}

std::vector<double> ProjectedPoints::std(const Posterior& posterior) const {
  if (by_shared_.rows() == 0) return {};
  return largestStds(posterior.whitened(by_shared_, by_motion_));
}

DirectedPoint ProjectedPoints::alongLargest(std::size_t i, const Posterior& posterior) const {
  const auto by_shared = by_shared_.middleRows<2>(2 * Eigen::Index(i)),
             by_motion = by_motion_.middleRows<2>(2 * Eigen::Index(i));
  const Eigen::MatrixXd w = posterior.whitened(by_shared, by_motion);
  const double uu = w.col(0).squaredNorm(), uv = w.col(0).dot(w.col(1)), vv = w.col(1).squaredNorm();
  const double angle = std::atan2(2 * uv, uu - vv) / 2;
  const Eigen::RowVector2d direction(std::cos(angle), std::sin(angle));
  return {direction * by_shared, direction * by_motion};
}

ProjectedPoints ProjectedPoints::at(const std::vector<std::size_t>& which) const {
  ProjectedPoints result;
  const auto rows = 2 * Eigen::Index(which.size());
  result.by_shared_.resize(rows, by_shared_.cols());
  result.by_motion_.resize(rows, 6);
  for (std::size_t i = 0; i < which.size(); ++i) {
    const Eigen::Index from = 2 * Eigen::Index(which[i]), to = 2 * Eigen::Index(i);
    result.by_shared_.middleRows<2>(to) = by_shared_.middleRows<2>(from);
    result.by_motion_.middleRows<2>(to) = by_motion_.middleRows<2>(from);
  }
  return result;
}

double largestStd(double uu, double uv, double vv) {
  return std::sqrt((uu + vv) / 2 + std::hypot((uu - vv) / 2, uv));
}

ProjectedPoint projectedPoint(const FittedRig& rig, std::size_t c, const vec3& ray, double distance_m) {
  const SharedColumns& columns = rig.columns;
  const Eigen::Matrix3d R = rig.left2camera[c].orient.toRotationMatrix();
  const Lens::Projection q = rig.lenses[c].differentiate(ray);
  // In the left camera the point is distance * direction + origin. A shift of one metre at this distance moves its
  // pixel by by_point.
  const Eigen::Vector3d direction = R.transpose() * ray, origin = -(R.transpose() * rig.left2camera[c].pos);
  const Eigen::Matrix<double, 2, 3> by_point = q.by_point / distance_m, by_left = by_point * R;
  const Eigen::Matrix<double, 2, 3> by_turn =
      q.by_point * R * crossMatrix(direction) + by_left * crossMatrix(origin);
  ProjectedPoint point;
  point.by_shared.setZero(2, columns.size);
  point.by_shared.middleCols(columns.lens[c], q.by_parameters.cols()) = q.by_parameters;
  point.by_motion << -by_left, by_turn;  // the new frame sees the point moved back by the motion
  if (c > 0) point.by_shared.middleCols<6>(columns.pose[c]) << by_point, -by_turn;
  return point;
}

CameraPosterior::CameraPosterior(const FittedRig& rig, const Posterior& posterior, std::size_t c)
    : lens_(rig.lenses[c]), left2camera_(rig.left2camera[c].orient.toRotationMatrix()) {
  // Rows of (t, s, p): t = motion.rotation - pose.rotation in the left camera; s, in this camera, is the motion of
  // its centre.
  const SharedColumns& columns = rig.columns;
  const int n = lens_.parameters();
  const Eigen::Vector3d origin = -(left2camera_.transpose() * rig.left2camera[c].pos);
  const Eigen::Matrix3d shift_by_turn = left2camera_ * crossMatrix(origin);
  Eigen::MatrixXd by_shared = Eigen::MatrixXd::Zero(most + 6, columns.size),
                  by_motion = Eigen::MatrixXd::Zero(most + 6, 6);
  by_motion.block<3, 3>(0, 3).setIdentity();
  by_motion.middleRows<3>(3) << -left2camera_, shift_by_turn;
  if (c > 0) {
    by_shared.block<3, 3>(0, columns.pose[c] + 3) = -Eigen::Matrix3d::Identity();
    by_shared.block<3, 6>(3, columns.pose[c]) << Eigen::Matrix3d::Identity(), -shift_by_turn;
  }
  by_shared.block(6, columns.lens[c], n, n).setIdentity();
  const Eigen::MatrixXd whitened = posterior.whitened(by_shared, by_motion);
  Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(whitened.rows(), most + 6), most + 6);
  padded.topRows(whitened.rows()) = whitened;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(padded);
  for (int j = 0; j < most + 6; ++j) {
    root_[std::size_t(j)].fill(Eigen::Array4d::Zero());
    for (int i = 0; i <= j; ++i) root_[std::size_t(j)][std::size_t(i / 4)][i % 4] = qr.matrixQR()(i, j);
  }
}

PixelCovariance CameraPosterior::Spread::at(double distance_m) const {
  const Eigen::Matrix2d sum = far + (mixed + near / distance_m) / distance_m;
  return {sum(0, 0), sum(0, 1), sum(1, 1)};
}

CameraPosterior::Spread CameraPosterior::spreadOf(const vec3& ray) const {
  const Lens::Projection q = lens_.differentiate(ray);
  const Eigen::Vector3d direction = left2camera_.transpose() * ray;
  const Eigen::Matrix<double, 2, 3> by_turn = q.by_point * left2camera_ * crossMatrix(direction);
  struct Whitened {
    Whitened() { u.fill(Eigen::Array4d::Zero()), v.fill(Eigen::Array4d::Zero()); }
    Column u, v;
  } far, near;
  const auto add = [this](Whitened& w, std::size_t column, const Eigen::Vector2d& by_it) {
    for (std::size_t i = 0; i <= column / 4; ++i) {
      w.u[i] += by_it[0] * root_[column][i];
      w.v[i] += by_it[1] * root_[column][i];
    }
  };
  for (int i = 0; i < 3; ++i)
    add(far, std::size_t(i), by_turn.col(i)), add(near, std::size_t(3 + i), q.by_point.col(i));
  for (int i = 0; i < q.by_parameters.cols(); ++i) add(far, std::size_t(6 + i), q.by_parameters.col(i));
  const auto product = [](const Column& a, const Column& b) {
    Eigen::Array4d sum = a[0] * b[0];
    for (std::size_t i = 1; i < a.size(); ++i) sum += a[i] * b[i];
    return sum.sum();
  };
  const auto symmetric = [](double uu, double uv, double vv) { return Eigen::Matrix2d{{uu, uv}, {uv, vv}}; };
  return {symmetric(product(far.u, far.u), product(far.u, far.v), product(far.v, far.v)),
          symmetric(2 * product(far.u, near.u), product(far.u, near.v) + product(far.v, near.u),
                    2 * product(far.v, near.v)),
          symmetric(product(near.u, near.u), product(near.u, near.v), product(near.v, near.v))};
}

std::vector<double> CameraPosterior::stdOfRays(const std::vector<std::optional<vec3>>& rays) const {
  std::vector<double> result;
  for (const auto& ray : rays) {
    if (ray) result.push_back(covarianceAt(*ray, std::numeric_limits<double>::infinity()).largestStd());
  }
  return result;
}

std::vector<ProjectionUncertainty> CameraPosterior::maps(const ImageGrid& grid,
                                                         const std::vector<std::optional<vec3>>& rays,
                                                         const std::vector<double>& distances_m) const {
  std::vector<ProjectionUncertainty> maps;
  for (const double distance : distances_m) {
    maps.emplace_back().distance_m = distance;
    maps.back().std_px.reserve(rays.size());
  }
  for (const auto& ray : rays) {
    if (!ray) {
      for (ProjectionUncertainty& map : maps) map.std_px.push_back(unknown);
      continue;
    }
    const Spread spread = spreadOf(*ray);
    for (ProjectionUncertainty& map : maps) map.std_px.push_back(spread.at(map.distance_m).largestStd());
  }
  for (ProjectionUncertainty& map : maps) summarise(grid, map);
  return maps;
}

std::vector<std::optional<vec3>> raysOf(const Lens& lens, const ImageGrid& grid) {
  std::vector<std::optional<vec3>> rays;
  for (int i = 0; i < grid.size(); ++i) {  // starts from the left or the upper neighbour, if it has a ray
    const int neighbour = i % grid.columns > 0 ? i - 1 : i - grid.columns;
    const bool has_start = neighbour >= 0 && rays[std::size_t(neighbour)];
    rays.push_back(has_start ? lens.unproject(grid.node(i), *rays[std::size_t(neighbour)])
                             : lens.unproject(grid.node(i)));
  }
  return rays;
}

}  // namespace slom::calibration
