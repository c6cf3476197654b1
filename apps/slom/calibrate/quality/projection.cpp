#include "calibrate/quality/projection.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/cross_matrix.hpp"

namespace slom::app::calib {
Knowledge::Knowledge(const Information& information)
    : shared(information.covariance()),
      motion_by_shared(information.motionByShared()),
      motion_noise(information.motionNoise()) {}

Eigen::Matrix2d ProjectedPoint::covariance(const Knowledge& knowledge) const {
  const Eigen::MatrixXd J = by_shared + by_motion * knowledge.motion_by_shared;
  return J * knowledge.shared * J.transpose() + by_motion * knowledge.motion_noise * by_motion.transpose();
}

double ProjectedPoint::std(const Knowledge& knowledge) const { return largestStd(covariance(knowledge)); }

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

std::vector<double> ProjectedPoints::std(const Knowledge& knowledge) const {
  if (by_shared_.rows() == 0) return {};
  const Eigen::MatrixXd J = by_shared_ + by_motion_ * knowledge.motion_by_shared;
  const Eigen::MatrixXd JC = J * knowledge.shared, EN = by_motion_ * knowledge.motion_noise;
  const auto squares = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return Eigen::VectorXd(a.cwiseProduct(b).rowwise().sum());
  };
  const Eigen::VectorXd diagonal = squares(JC, J) + squares(EN, by_motion_);
  std::vector<double> result;
  for (Eigen::Index i = 0; i < J.rows(); i += 2) {
    Eigen::Matrix2d covariance;
    covariance(0, 0) = diagonal[i];
    covariance(1, 1) = diagonal[i + 1];
    covariance(0, 1) = covariance(1, 0) = JC.row(i).dot(J.row(i + 1)) + EN.row(i).dot(by_motion_.row(i + 1));
    result.push_back(largestStd(covariance));
  }
  return result;
}

double largestStd(const Eigen::Matrix2d& covariance) {
  const double mean = covariance.trace() / 2;
  return std::sqrt(mean + std::hypot((covariance(0, 0) - covariance(1, 1)) / 2, covariance(0, 1)));
}

ProjectedPoint projectedPoint(const FittedRig& rig, std::size_t c, const vec3& ray, double distance_m) {
  const bool is_far = std::isinf(distance_m);
  const SharedColumns& columns = rig.columns;
  const Eigen::Matrix3d R = rig.left2camera[c].orient.toRotationMatrix();
  const vec3 in_camera = is_far ? ray : vec3(distance_m * ray);
  const vec3 in_left = is_far ? vec3(R.transpose() * ray) : vec3(rig.left2camera[c].inverse() * in_camera);
  const Lens::Projection q = rig.lenses[c]->differentiate(in_camera);
  const Eigen::Matrix<double, 2, 3> by_left = q.by_point * R;

  ProjectedPoint point;
  point.by_shared = Eigen::MatrixXd::Zero(2, columns.size);
  point.by_shared.middleCols(columns.lens[c], q.by_parameters.cols()) = q.by_parameters;
  // The new frame sees the point where the motion takes it back to.
  point.by_motion << -by_left, by_left * crossMatrix(in_left);
  if (is_far) point.by_motion.leftCols<3>().setZero();
  if (c == 0) return point;
  if (!is_far) point.by_shared.middleCols<3>(columns.pose[c]) = q.by_point;
  point.by_shared.middleCols<3>(columns.pose[c] + 3) = -by_left * crossMatrix(in_left);
  return point;
}

std::vector<std::optional<vec3>> raysOf(const Lens& lens, const ImageGrid& grid) {
  std::vector<std::optional<vec3>> rays;
  for (int i = 0; i < grid.size(); ++i) {  // from a neighbour that has one: the left or the upper
    const int neighbour = i % grid.columns > 0 ? i - 1 : i - grid.columns;
    const bool has_start = neighbour >= 0 && rays[std::size_t(neighbour)];
    rays.push_back(has_start ? lens.unproject(grid.node(i), *rays[std::size_t(neighbour)])
                             : lens.unproject(grid.node(i)));
  }
  return rays;
}

ProjectionUncertainty projectionUncertainty(const FittedRig& rig, const Knowledge& knowledge, std::size_t c,
                                            const ImageGrid& grid,
                                            const std::vector<std::optional<vec3>>& rays, double distance_m) {
  ProjectionUncertainty result;
  result.distance_m = distance_m;
  std::vector<ProjectedPoint> points;
  for (const auto& ray : rays) {
    if (ray) points.push_back(projectedPoint(rig, c, *ray, distance_m));
  }
  std::vector<double> known = ProjectedPoints(points).std(knowledge);
  auto next = known.begin();
  for (const auto& ray : rays) result.std_px.push_back(ray ? *next++ : unknown);
  std::sort(known.begin(), known.end());
  result.middle_px = result.std_px[std::size_t(grid.middle())];
  result.median_px = known.empty() ? unknown : known[known.size() / 2];
  result.worst_px = known.empty() ? unknown : known.back();
  return result;
}

}  // namespace slom::app::calib
