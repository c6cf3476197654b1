#include "calibration/quality/uncertainty/whitened_scores.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibration/symmetric.hpp"

namespace slom::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double alone = 1e-6;  // value of 1 - leverage below which a group alone determines a direction

constexpr double least_redundancy = 0.01;  // of a corner that others check, in its smaller direction

/// Contribution of one group to the sums of byBlocks.
struct GroupPart {
  MatrixXd V;  // w w^T, and the stated part of directions that the group alone determines
  MatrixXd
      squares;  // B A B^T, with the correction B: |B^T x|^2 of a parameter with row k of K is k squares k^T
  MatrixXd follows;  // (A, W) B^T: all unknowns follow it by `follows` k^T
};

/// Computes the part of one group. In the working model, the group's score has the covariance A before the group's
/// own part of the fit is removed, and A - D after. D = A^2 + W^T W includes the group's information about the board.
/// Let N = A^(-1/2) D A^(-1/2), which is A without a board. The correction A^(1/2) (I - N)^(-1/2) A^(-1/2) leads from
/// the second covariance back to the first.
GroupPart partOf(const MatrixXd& leverage, const MatrixXd& on_board, const VectorXd& score) {
  const SymmetricEigen own = eigenOf(leverage);
  const VectorXd root = own.eigenvalues().cwiseMax(0).cwiseMin(1).cwiseSqrt();
  const double least =
      root.size() > 0 ? 1e-8 * root.maxCoeff() : 0;  // below, the group does not determine a direction
  const VectorXd inverse = root.unaryExpr([&](double r) { return r > least ? 1 / r : 0.0; });
  const MatrixXd& U = own.eigenvectors();
  const MatrixXd W = on_board * U * inverse.asDiagonal();
  MatrixXd N = W.transpose() * W;
  N.diagonal() += root.cwiseAbs2();
  const SymmetricEigen eigen = eigenOf(N);
  const VectorXd nu = eigen.eigenvalues().cwiseMax(0).cwiseMin(1);
  const auto is_alone = [](double n) { return 1 - n < alone; };
  const VectorXd correction =
      nu.unaryExpr([&](double n) { return is_alone(n) ? 0.0 : 1 / std::sqrt(1 - n); });
  const VectorXd determined_alone = nu.unaryExpr([&](double n) { return is_alone(n) ? 1.0 : 0.0; });
  const MatrixXd& P = eigen.eigenvectors();
  const MatrixXd outer = U * root.asDiagonal() * P;  // A^(1/2) in the directions of N
  const MatrixXd B = outer * correction.asDiagonal() * P.transpose() * inverse.asDiagonal() * U.transpose();
  const VectorXd w = B * score;
  MatrixXd follows(leverage.rows() + on_board.rows(), leverage.cols());
  follows << leverage * B.transpose(), on_board * B.transpose();
  return {w * w.transpose() + composed(outer, determined_alone), composed(outer, correction.cwiseAbs2()),
          follows};
}

/// Returns the cr1 factor, for groups with small leverages.
double smallSampleFactor(int groups) { return groups > 1 ? groups / (groups - 1.0) : 1; }

}  // namespace

Posterior statedPosterior(const Dataset& data, const FittedRig& rig, const Information& information) {
  return rig.board ? Posterior(information, WhitenedScores(data, rig).statedCovariance())
                   : Posterior(information);
}

WhitenedScores::WhitenedScores(const Dataset& data, const FittedRig& rig) : shared_(rig.columns.size) {
  const int n = shared_ + (rig.board ? rig.board->unknowns() : 0);
  const std::map<int, Observation> observations = observationsOf(data, rig);
  VectorXd prior = VectorXd::Zero(n);
  if (rig.sigma_denominator) {
    for (const int column : rig.columns.held_near_zero)
      prior[column] = 1 / (*rig.sigma_denominator * *rig.sigma_denominator);
  }
  if (rig.board) prior.tail(n - shared_).setConstant(1 / (rig.board->sigma() * rig.board->sigma()));
  MatrixXd sum = prior.asDiagonal();
  struct Pose {
    Eigen::Matrix<double, 6, Eigen::Dynamic> by_shared;
    Matrix6 inverse;
  };
  std::vector<Pose> poses;
  for (const auto& [image, observation] : observations) {
    const ImageEquations equations = equationsWithBoard(rig, observation);
    sum.triangularView<Eigen::Lower>() += equations.H.topLeftCorner(n, n);
    sum.triangularView<Eigen::Lower>() -=
        equations.H.bottomRows<6>().leftCols(n).transpose() * equations.pose_by_shared;
    poses.push_back({equations.pose_by_shared, equations.pose_inverse});
  }
  factorise(rig.columns, sum);
  prior_ = K_.transpose() * prior.asDiagonal() * K_;
  auto pose = poses.begin();
  for (const auto& [image, observation] : observations) {
    images_.push_back({MatrixXd::Zero(K_.cols(), K_.cols()), VectorXd::Zero(K_.cols()),
                       MatrixXd::Zero(n - shared_, K_.cols())});
    const MatrixXd by_pose = K_.transpose() * pose->by_shared.transpose();
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      if (const View* const view = data.cameras[c].find(image))
        addView(rig, *view, c, observation.left2world, by_pose, pose->inverse);
    }
    if (observation.acc) addReading(rig, observation, by_pose);
    ++pose;
  }
}

/// Factorises the information. Orders the unknowns of the board first. Then, in the last columns of the inverse of
/// the upper triangle, the rows of the shared parameters are a root of their covariance.
void WhitenedScores::factorise(const SharedColumns& columns, const MatrixXd& sum) {
  std::vector<int> order;
  for (int i = columns.size; i < sum.rows(); ++i) order.push_back(i);
  order.insert(order.end(), columns.free.begin(), columns.free.end());
  const MatrixXd all = sum.selfadjointView<Eigen::Lower>();
  const MatrixXd information = all(order, order);
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(scaledOnBothSides(information, scale));
  const auto n = Index(columns.free.size()), size = Index(order.size()), of_board = size - n;
  MatrixXd upper = MatrixXd::Zero(size, n);
  upper.bottomRows(n).setIdentity();
  factor.matrixU().solveInPlace(upper);
  K_ = MatrixXd::Zero(sum.rows(), n);
  for (Index i = 0; i < size; ++i) K_.row(order[std::size_t(i)]) = scale[i] * upper.row(i);
  board_factor_ = factor.matrixLLT().topLeftCorner(of_board, of_board);
  board_scale_ = scale.head(of_board);
}

MatrixXd WhitenedScores::onBoard(const Image& group) const {
  MatrixXd W = board_scale_.asDiagonal() * group.on_board;
  board_factor_.triangularView<Eigen::Lower>().solveInPlace(W);
  return W;
}

void WhitenedScores::addView(const FittedRig& rig, const View& view, std::size_t c, const SE3& left2world,
                             const MatrixXd& by_pose, const Matrix6& pose_inverse) {
  const SeenBoard board = rig.seenBoard(c, left2world);
  const auto of_camera = Index(rig.columns.of_camera[c]), corners = Index(view.corners.size());
  // All rows of the view at once, as K^T times the derivatives by the camera, by its place and by the rig's pose.
  MatrixXd by_view(K_.cols(), of_camera + 12), derivatives(of_camera + 12, 2 * corners);
  by_view << K_.middleRows(rig.columns.lens[c], of_camera).transpose(),
      (c > 0 ? MatrixXd(K_.middleRows<6>(rig.columns.pose[c]).transpose()) : MatrixXd::Zero(K_.cols(), 6)),
      -by_pose;
  VectorXd residuals(2 * corners), weights(corners);
  for (Index k = 0; k < corners; ++k) {
    const Corner& corner = view.corners[std::size_t(k)];
    const SeenBoard::Rows seen = board.rowsOf(corner.world);
    derivatives.middleCols<2>(2 * k) << byCamera(rig.columns, c, seen, corner).transpose(),
        seen.byLeft2Camera().transpose(), seen.byLeft2World().transpose();
    residuals.segment<2>(2 * k) = corner.pixel - seen.pixel();
    weights[k] = 1 / (rig.sigma_px * corner.sigma);
  }
  MatrixXd rows = by_view * derivatives;
  if (rig.board) addBoard(rig, view, board, weights, rows);
  ViewScores scores{images() - 1, {}, MatrixXd(K_.cols(), corners), VectorXd(corners)};
  for (Index k = 0; k < corners; ++k) {
    auto own = rows.middleCols<2>(2 * k);
    own *= weights[k];
    const auto by_left2world = derivatives.bottomRows<6>().middleCols<2>(2 * k);
    const Eigen::Vector2d residual = residuals.segment<2>(2 * k);
    const Eigen::Matrix2d leverage =
        weights[k] * weights[k] * (by_left2world.transpose() * pose_inverse * by_left2world) +
        own.transpose() * own;  // 2 x 2, of u and v
    const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - leverage;
    const bool is_checked = rest.determinant() > least_redundancy * rest.trace();
    const Eigen::Vector2d without = is_checked ? Eigen::Vector2d(rest.inverse() * residual) : residual;
    tests_.push_back({without.norm(), std::sqrt(std::max(0.0, residual.dot(without)))});
    scores.scores.col(k).noalias() = own * (weights[k] * residual);
    scores.leverage[k] = own.squaredNorm();
    scores.points.push_back(
        points_.emplace(keyOf(view.corners[std::size_t(k)].world), int(points_.size())).first->second);
  }
  images_.back().leverage.noalias() += rows * rows.transpose();
  images_.back().score += scores.scores.rowwise().sum();
  views_.push_back(std::move(scores));
}

/// Adds what rows owe to the unknowns of the board, and the image's information on these.
void WhitenedScores::addBoard(const FittedRig& rig, const View& view, const SeenBoard& board,
                              const VectorXd& weights, MatrixXd& rows) {
  for (Index k = 0; k < weights.size(); ++k) {
    const vec3& world = view.corners[std::size_t(k)].world;
    const auto [first, map] = rig.board->of(world);
    const Eigen::Matrix<double, 2, 3> by_board = board.rowsOf(world).by_point * *map;
    auto own = rows.middleCols<2>(2 * k);
    own.noalias() += K_.middleRows<3>(shared_ + first).transpose() * by_board.transpose();
    // All rows of an image are orthogonal to its pose, so the part of the board in the pose need not be removed.
    images_.back().on_board.middleRows<3>(first).noalias() +=
        weights[k] * weights[k] * (by_board.transpose() * own.transpose());
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
  const Eigen::MatrixXd rows = K_.middleRows<7>(rig.columns.imu).transpose() * by_imu.transpose() -
                               by_pose * by_pose_of_reading.transpose();
  images_.back().leverage.noalias() += weight * (rows * rows.transpose());
  images_.back().score -= weight * (rows * residual);
}

/// Satterthwaite's degrees of freedom are 2 E(V)^2 / Var(V) = (tr B)^2 / tr B^2 of B_gh = delta_gh |A_g x_g|^2 -
/// y_g^T C y_h.
GroupSums WhitenedScores::byBlocks(int length) const {
  const Index n = K_.cols();
  const int blocks = std::max(1, images() / length);
  std::vector<Image> groups(
      std::size_t(blocks), {MatrixXd::Zero(n, n), VectorXd::Zero(n), MatrixXd::Zero(board_scale_.size(), n)});
  for (int i = 0; i < images(); ++i) {
    Image& group = groups[std::size_t(blockOf(i, length))];
    group.leverage += images_[std::size_t(i)].leverage;
    group.score += images_[std::size_t(i)].score;
    group.on_board += images_[std::size_t(i)].on_board;
  }
  GroupSums sums{prior_, VectorXd::Constant(shared_, unknown), blocks};
  std::vector<GroupPart> parts;
  for (const Image& group : groups) {
    parts.push_back(partOf(group.leverage, onBoard(group), group.score));
    sums.V += parts.back().V;
  }
  for (Index p = 0; p < shared_; ++p) {
    const VectorXd k = K_.row(p).transpose();
    if (k.squaredNorm() == 0) continue;
    double trace = 0, of_square = 0;
    MatrixXd Y = MatrixXd::Zero(n + board_scale_.size(), blocks);
    for (int g = 0; g < blocks; ++g) {
      const GroupPart& part = parts[std::size_t(g)];
      Y.col(g) = part.follows * k;
      const double square = k.dot(part.squares * k), followed = Y.col(g).squaredNorm();
      trace += square - followed;
      of_square += square * square - 2 * square * followed;
    }
    of_square += Y.rows() < Y.cols() ? (Y * Y.transpose()).squaredNorm() : (Y.transpose() * Y).squaredNorm();
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
  for (const ViewScores& view : views_) {
    for (Index k = 0; k < view.leverage.size(); ++k) {
      const int point = view.points[std::size_t(k)];
      score.col(Index(point) * blocks + blockOf(view.image, length)) += view.scores.col(k);
      of_point.col(point) += view.scores.col(k);
      leverage[point] += view.leverage[k];
    }
  }
  sums.by_point = smallSampleFactor(sums.points) * of_point * of_point.transpose();
  sums.by_both = smallSampleFactor(sums.points * blocks) * score * score.transpose();
  sums.dof = std::max(1.0, std::pow(leverage.sum(), 2) / leverage.squaredNorm() - 1);
  return sums;
}

}  // namespace slom::calibration
