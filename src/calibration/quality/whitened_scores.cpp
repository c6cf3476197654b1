#include "calibration/quality/whitened_scores.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "calibration/cross_matrix.hpp"

namespace slom::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double alone = 1e-6;  // 1 - leverage, below which a group determines a direction alone

constexpr double least_redundancy = 0.01;  // of a corner that others check, of its smaller direction

/// K with K K^T = (sum Lambda)^-1, of the lower triangle of the sum.
MatrixXd rootOfInverse(const SharedColumns& columns, const MatrixXd& sum) {
  const auto& free = columns.free;
  const MatrixXd all = sum.selfadjointView<Eigen::Lower>();
  const MatrixXd information = all(free, free);
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(scale.asDiagonal() * information * scale.asDiagonal());
  const auto n = Index(free.size());
  const MatrixXd upper = factor.matrixU().solve(MatrixXd::Identity(n, n));
  MatrixXd K = MatrixXd::Zero(columns.size, n);
  for (Index i = 0; i < n; ++i) K.row(free[std::size_t(i)]) = scale[i] * upper.row(i);
  return K;
}

/// What one group adds to the sums of byBlocks.
struct GroupPart {
  MatrixXd V;        // w w^T, and the stated part of what the group determines alone
  MatrixXd squares;  // N (I - N)^-1: |A x|^2 of a parameter with row k of K is k squares k^T
  MatrixXd follows;  // N (I - N)^(-1/2): y of it is `follows` k^T
};

GroupPart partOf(const MatrixXd& leverage, const VectorXd& score) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(leverage);
  const VectorXd lambda = eigen.eigenvalues().cwiseMax(0).cwiseMin(1);
  const MatrixXd& U = eigen.eigenvectors();
  const VectorXd correction =
      lambda.unaryExpr([](double l) { return 1 - l < alone ? 0.0 : 1 / std::sqrt(1 - l); });
  const VectorXd stated = lambda.unaryExpr([](double l) { return 1 - l < alone ? l : 0.0; });
  const VectorXd w = U * (correction.asDiagonal() * (U.transpose() * score));
  return {w * w.transpose() + U * stated.asDiagonal() * U.transpose(),
          U * lambda.cwiseProduct(correction.cwiseAbs2()).asDiagonal() * U.transpose(),
          U * lambda.cwiseProduct(correction).asDiagonal() * U.transpose()};
}

/// The cr1 factor of groups whose single leverages are small.
double smallSampleFactor(int groups) { return groups > 1 ? groups / (groups - 1.0) : 1; }

}  // namespace

WhitenedScores::WhitenedScores(const Dataset& data, const FittedRig& rig) {
  const int n = rig.columns.size;
  const std::map<int, Observation> observations = observationsOf(data, rig);
  MatrixXd prior = MatrixXd::Zero(n, n);
  if (rig.sigma_denominator) {
    for (const int column : rig.columns.held_near_zero)
      prior(column, column) = 1 / (*rig.sigma_denominator * *rig.sigma_denominator);
  }
  MatrixXd sum = prior;
  std::vector<ImageEquations> equations;
  std::vector<MatrixXd> shares;
  for (const auto& [image, observation] : observations) {
    equations.push_back(equationsOf(rig, observation));
    const MatrixXd& H = equations.back().H;
    shares.push_back(H.topLeftCorner(n, n) -
                     H.bottomRows<6>().leftCols(n).transpose() * equations.back().pose_by_shared);
    sum += shares.back();
  }
  K_ = rootOfInverse(rig.columns, sum);
  prior_ = K_.transpose() * prior * K_;
  std::size_t i = 0;
  for (const auto& [image, observation] : observations) {
    const MatrixXd share = shares[i].selfadjointView<Eigen::Lower>();
    images_.push_back({K_.transpose() * share * K_, VectorXd::Zero(K_.cols())});
    const MatrixXd by_pose = K_.transpose() * equations[i].pose_by_shared.transpose();
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      if (const View* const view = data.cameras[c].find(image))
        addView(rig, *view, c, observation.left2world, by_pose, equations[i].pose_inverse);
    }
    if (observation.acc) addReading(rig, observation, by_pose);
    ++i;
  }
}

void WhitenedScores::addView(const FittedRig& rig, const View& view, std::size_t c, const SE3& left2world,
                             const MatrixXd& by_pose, const Matrix6& pose_inverse) {
  const Eigen::Matrix3d R = rig.left2camera[c].orient.toRotationMatrix();
  const Eigen::Matrix3d world2left = left2world.orient.toRotationMatrix().transpose();
  const Lens& lens = *rig.lenses[c];
  const int n = lens.parameters();
  const MatrixXd by_lens = K_.middleRows(rig.columns.lens[c], n).transpose();
  const MatrixXd by_left2camera =
      c == 0 ? MatrixXd() : MatrixXd(K_.middleRows<6>(rig.columns.pose[c]).transpose());
  const double weight = 1 / rig.sigma_px;
  Eigen::Matrix<double, 2, 6> pose;
  Eigen::Matrix<double, Eigen::Dynamic, 2> rows(K_.cols(), 2);
  for (const Corner& corner : view.corners) {
    const Eigen::Vector3d in_left = world2left * (corner.world - left2world.pos);
    const Lens::Projection q = lens.differentiate(vec3(R * in_left + rig.left2camera[c].pos));
    const Eigen::Matrix<double, 2, 3> by_left = q.by_point * R, by_turn = by_left * crossMatrix(in_left);
    rows.noalias() = by_lens * q.by_parameters.transpose();
    if (c > 0) {
      pose << q.by_point, -by_turn;
      rows.noalias() += by_left2camera * pose.transpose();
    }
    pose << -by_left * world2left, by_turn;
    rows.noalias() -= by_pose * pose.transpose();
    const Eigen::Vector2d residual = corner.pixel - q.pixel;
    const Eigen::Matrix2d leverage =
        weight * weight *
        (pose * pose_inverse * pose.transpose() + rows.transpose() * rows);  // 2 x 2, of u and v
    const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - leverage;
    const bool is_checked = rest.determinant() > least_redundancy * rest.trace();
    const Eigen::Vector2d without = is_checked ? Eigen::Vector2d(rest.inverse() * residual) : residual;
    tests_.push_back({without.norm(), std::sqrt(std::max(0.0, residual.dot(without)))});
    const VectorXd score = weight * weight * (rows * residual);
    images_.back().score += score;
    const std::array<double, 3> place{corner.world.x(), corner.world.y(), corner.world.z()};
    const int point = points_.emplace(place, int(points_.size())).first->second;
    corners_.push_back({point, images() - 1, weight * weight * rows.squaredNorm(), score});
  }
}

void WhitenedScores::addReading(const FittedRig& rig, const Observation& observation,
                                const MatrixXd& by_pose) {
  const auto [by_imu, by_pose_of_reading] = differentiateReading(rig, observation);
  const Eigen::Vector3d in_left =
      rig.imu->left2imu.toRotationMatrix().transpose() * (*observation.acc - rig.imu->acc_bias);
  Eigen::Vector3d residual = observation.left2world.orient.toRotationMatrix() * in_left;
  residual.z() -= rig.imu->gravity;
  const double weight = 1 / (rig.sigma_acc * rig.sigma_acc);
  images_.back().score -=
      weight * (K_.middleRows<7>(rig.columns.imu).transpose() * (by_imu.transpose() * residual) -
                by_pose * (by_pose_of_reading.transpose() * residual));
}

/// Satterthwaite's degrees of freedom are 2 E(V)^2 / Var(V) = (tr B)^2 / tr B^2 of B_gh = delta_gh |A_g x_g|^2 - y_g^T C y_h.
GroupSums WhitenedScores::byBlocks(int length) const {
  const Index n = K_.cols();
  const int blocks = std::max(1, images() / length);
  std::vector<Image> groups(std::size_t(blocks), {MatrixXd::Zero(n, n), VectorXd::Zero(n)});
  for (int i = 0; i < images(); ++i) {
    Image& group = groups[std::size_t(blockOf(i, length))];
    group.leverage += images_[std::size_t(i)].leverage;
    group.score += images_[std::size_t(i)].score;
  }
  GroupSums sums{prior_, VectorXd::Constant(K_.rows(), unknown), blocks};
  std::vector<GroupPart> parts;
  for (const Image& group : groups) {
    parts.push_back(partOf(group.leverage, group.score));
    sums.V += parts.back().V;
  }
  for (Index p = 0; p < K_.rows(); ++p) {
    const VectorXd k = K_.row(p).transpose();
    if (k.squaredNorm() == 0) continue;
    double trace = 0, of_square = 0;
    MatrixXd Y = MatrixXd::Zero(n, blocks);
    for (int g = 0; g < blocks; ++g) {
      const GroupPart& part = parts[std::size_t(g)];
      Y.col(g) = part.follows * k;
      const double square = k.dot(part.squares * k), followed = Y.col(g).squaredNorm();
      trace += square - followed;
      of_square += square * square - 2 * square * followed;
    }
    of_square += (Y.transpose() * Y).squaredNorm();
    if (of_square > 0) sums.dof[p] = trace * trace / of_square;
  }
  return sums;
}

BoardPointSums WhitenedScores::byBoardPoints(int length) const {
  const Index n = K_.cols();
  const int blocks = std::max(1, images() / length);
  BoardPointSums sums{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n), 0, int(points_.size())};
  MatrixXd score = MatrixXd::Zero(n, Index(sums.points) * blocks), of_point = MatrixXd::Zero(n, sums.points);
  VectorXd leverage = VectorXd::Zero(sums.points);
  for (const CornerScore& corner : corners_) {
    score.col(Index(corner.point) * blocks + blockOf(corner.image, length)) += corner.score;
    of_point.col(corner.point) += corner.score;
    leverage[corner.point] += corner.leverage;
  }
  sums.by_point = smallSampleFactor(sums.points) * of_point * of_point.transpose();
  sums.by_both = smallSampleFactor(sums.points * blocks) * score * score.transpose();
  sums.dof = std::max(1.0, std::pow(leverage.sum(), 2) / leverage.squaredNorm() - 1);
  return sums;
}

}  // namespace slom::calibration
