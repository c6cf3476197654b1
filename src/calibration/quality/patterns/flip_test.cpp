#include "calibration/quality/patterns/flip_test.hpp"

#include <cmath>

#include "calibration/symmetric.hpp"

namespace slom::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Fraction of a pattern that must remain after poses and shared parameters have followed it. With many cells, the
/// part that they take from each other is not accounted for.
constexpr double least_visible = 1e-3, least_visible_of_one = 1e-8;

/// Returns the inverse of N on the directions that are visible relative to `square`, 0 on others.
MatrixXd visibleInverse(const MatrixXd& N, const VectorXd& square, double least) {
  const VectorXd scale = square.unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.0; });
  const SymmetricEigen eigen = eigenOf(scaledOnBothSides(N, scale));
  const VectorXd inverse = eigen.eigenvalues().unaryExpr([&](double l) { return l > least ? 1 / l : 0.0; });
  const MatrixXd U = scale.asDiagonal() * eigen.eigenvectors();
  return composed(U, inverse);
}

constexpr double rounding = 1e-9;  // relative

/// Returns -1 where a bit is set, 1 elsewhere.
VectorXd signsOf(long bits, Index count) {
  VectorXd signs(count);
  for (Index i = 0; i < count; ++i) signs[i] = (bits >> i & 1) != 0 ? -1 : 1;
  return signs;
}

}  // namespace

double FlipTest::probability() const {
  const double observed = products_.sum() * (1 - rounding);
  long as_much = 0;
  const long all = 1L << (products_.rows() - 1);  // the first block keeps its sign
  for (long flips = 0; flips < all; ++flips) {
    const VectorXd signs = signsOf(2 * flips, products_.rows());
    as_much += signs.dot(products_ * signs) >= observed;
  }
  return double(as_much) / double(all);
}

double probabilityOfSum(const VectorXd& sums) {
  const double observed = sums.sum() - rounding * sums.cwiseAbs().sum();
  long as_much = 0;
  const long all = 1L << sums.size();
  for (long flips = 0; flips < all; ++flips) as_much += signsOf(flips, sums.size()).dot(sums) >= observed;
  return double(as_much) / double(all);
}

PatternScores::PatternScores(int cells, int unknowns, int blocks, int shared)
    : cells_(static_cast<std::size_t>(cells),
             {MatrixXd::Zero(unknowns, unknowns), VectorXd::Zero(unknowns), MatrixXd::Zero(shared, unknowns),
              MatrixXd::Zero(unknowns, blocks), MatrixXd::Zero(6, unknowns)}),
      products_(MatrixXd::Zero(blocks, blocks)) {}

void PatternScores::endView(const Eigen::Matrix<double, 6, 6>& pose_inverse) {
  for (const int cell : touched_) {
    Cell& own = cells_[static_cast<std::size_t>(cell)];
    own.N -= own.by_pose.transpose() * pose_inverse * own.by_pose;
    own.by_pose.setZero();
    own.is_touched = false;
  }
  touched_.clear();
}

void PatternScores::finish(const MatrixXd& covariance, const MatrixXd& scores) {
  for (Cell& own : cells_) {
    const MatrixXd solved = covariance * own.C;
    own.N -= own.C.transpose() * solved;
    own.scores -= solved.transpose() * scores;
    own.N = visibleInverse(own.N, own.square, cells() == 1 ? least_visible_of_one : least_visible);
    const MatrixXd estimates = own.N * own.scores;
    products_ += own.scores.transpose() * estimates;
    own.scores = estimates;
  }
}

}  // namespace slom::calibration
