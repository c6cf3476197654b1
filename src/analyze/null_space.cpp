#include "analyze/null_space.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/decompositions.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDamping = 1e-10;  // damping of the scaled J^T J, whose diagonal is 1
constexpr int kIterations = 6;
/// Bound on |J d| down to which the iteration separates directions: their |J d|^2 must differ by more than the damping.
/// A long chain has many directions that are nearly free.
constexpr double kSeparated = 3e-5;
/// Test that the null space is empty. From one iteration to the next, the square of the smallest influence |J d| falls
/// by a factor below kSettled. It also exceeds the square of the limit kFarAbove times.
constexpr double kSettled = 1.1, kFarAbove = 10;
constexpr Index kFirstCount = 4, kMostCount = 192;
/// Limit of unknowns x directions^2, to which the time is proportional: about 10 seconds.
constexpr double kMostWork = 1e9;

/// Returns squared lengths of columns, 0 for columns that are only rounding errors compared with the largest column of
/// the same variable. Units of its components may differ, but hardly by 1e14. A component that no residual depends on
/// often has such a column, such as the translation t in (R - I) t along the axis of R.
VectorXd withoutRounding(VectorXd diagonal, const BlockStructure& structure) {
  constexpr double rounding = 1e-14;
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (structure.isEmpty(b)) continue;
    auto own = diagonal.segment(structure.offset[static_cast<std::size_t>(b)], structure.dof(b));
    const double limit = rounding * rounding * own.maxCoeff();
    for (double& h : own) h = h < limit ? 0 : h;
  }
  return diagonal;
}

/// Returns pseudo-random numbers, the same in every run. Rows of unobservable unknowns, on which no residual depends,
/// are 0.
MatrixXd startVectors(const VectorXd& diagonal, Index count) {
  MatrixXd start(diagonal.size(), count);
  double x = 0.5;
  for (double& entry : start.reshaped()) {
    x += 0.6180339887498949 + 0.1 * x * (1 - x);
    x -= std::floor(x);
    entry = x - 0.5;
  }
  for (Index i = 0; i < start.rows(); ++i) {
    if (!(diagonal[i] > 0)) start.row(i).setZero();
  }
  return start;
}

/// Makes the columns of V orthonormal by two passes of Cholesky factorisation of V^T V. The passes consist of products
/// of matrices and are several times as fast as reflections. If columns are nearly parallel, uses reflections. Returns
/// the largest singular value of V, or 0 if it used reflections.
///   source   Yamamoto, Nakatsukasa, Yanagisawa and Fukaya, "Roundoff error analysis of the CholeskyQR2 algorithm",
///            2015
double orthonormalize(MatrixXd& V) {
  constexpr double most_of_condition = 1e12;  // largest condition number of V^T V
  const VectorXd lengths = V.colwise().norm();
  if (!(lengths.minCoeff() > 0) || !lengths.allFinite()) {
    V = orthonormalBasis(V);
    return 0;
  }
  V = V * lengths.cwiseInverse().asDiagonal();
  MatrixXd R = lengths.asDiagonal();  // original V = present V * R
  for (int pass = 0; pass < 2; ++pass) {
    const MatrixXd gram = V.transpose() * V;
    const SymmetricEigen eigen = eigenOf(gram);
    const VectorXd& squares = eigen.eigenvalues();
    if (!(squares[0] * most_of_condition > squares[squares.size() - 1])) {
      V = orthonormalBasis(V);
      return 0;
    }
    const VectorXd roots = squares.cwiseSqrt();
    const MatrixXd& Q = eigen.eigenvectors();
    V = V * MatrixXd(Q * roots.cwiseInverse().asDiagonal() * Q.transpose());
    R = MatrixXd(Q * roots.asDiagonal() * Q.transpose() * R);
  }
  return svdOf(R, 0).singularValues()[0];
}

/// Turns the columns of `result.direction` into the singular vectors of J within their span.
void sortByInfluence(const LinearizedProblem& linearized, NearNullSpace& result) {
  MatrixXd image = linearized.times(result.scale.cwiseInverse().asDiagonal() * result.direction);
  if (image.rows() > image.cols()) {
    triangularize(image);
    image = MatrixXd(image.topRows(image.cols()).triangularView<Eigen::Upper>());
  }
  const SVD svd = svdOf(image, Eigen::ComputeFullV);
  const Index count = result.direction.cols();
  result.influence.setZero(count);
  for (Index k = 0; k < svd.singularValues().size(); ++k)
    result.influence[count - 1 - k] = svd.singularValues()[k];
  result.direction = result.direction * svd.matrixV().rowwise().reverse();
}

/// Solutions with H if it has full rank, otherwise with H + damping.
class InverseIteration {
 public:
  InverseIteration(const LinearizedProblem& linearized, const NearNullSpace& shape)
      : linearized_(linearized) {
    MatrixXd ignored;
    const BlockStructure& structure = linearized.structure().system;
    if (shape.unobserved.empty() && linearized.isExact() &&
        linearized.solveFor(MatrixXd(structure.unknowns(), 0), ignored).ok)
      return;
    shift_ = kDamping;
    damping_ = kDamping * shape.scale.cwiseAbs2();
    for (const int i : shape.unobserved) damping_[i] = 1;
    damped_.emplace(BlockSolverOptions{.method = BlockSolverOptions::Method::cholesky});
    damped_->analyze(structure);
    linearized.rows().sendTo(*damped_);
  }

  SolveStatus solve(const MatrixXd& B, MatrixXd& X) {
    return damped_ ? damped_->solveDamped(damping_, B, X) : linearized_.solveFor(B, X);
  }
  /// Returns the damping in scaled unknowns; 0 if H has full rank.
  double shift() const { return shift_; }

 private:
  const LinearizedProblem& linearized_;
  std::optional<BlockSolver> damped_;
  VectorXd damping_;
  double shift_ = 0;
};

}  // namespace

NearNullSpace findNearNullSpace(const LinearizedProblem& linearized, double limit) {
  NearNullSpace result;
  const BlockStructure& structure = linearized.structure().system;
  const VectorXd diagonal = withoutRounding(linearized.diagonal(), structure);
  result.scale = diagonal.unaryExpr([](double h) { return h > 0 ? std::sqrt(h) : 1.0; });
  for (Index i = 0; i < diagonal.size(); ++i) {
    if (!(diagonal[i] > 0)) result.unobserved.push_back(static_cast<int>(i));
  }
  const Index dimension = diagonal.size() - static_cast<Index>(result.unobserved.size());
  if (dimension == 0) {
    result.direction.resize(diagonal.size(), 0);
    return result;
  }
  InverseIteration inverse(linearized, result);
  for (Index count = std::min(kFirstCount, dimension);;) {
    result.direction = startVectors(diagonal, count);
    orthonormalize(result.direction);
    double gain = 0;  // 1 / (smallest |J d|^2 so far + shift)
    bool all_determined = false;
    for (int i = 0; i < kIterations; ++i) {
      MatrixXd moved;
      const SolveStatus status = inverse.solve(result.scale.asDiagonal() * result.direction, moved);
      if (!status.ok) break;  // keeps the vectors found so far
      for (const int row : result.unobserved) moved.row(row).setZero();
      result.direction = result.scale.asDiagonal() * moved;
      const double last = std::exchange(gain, orthonormalize(result.direction));
      all_determined =
          gain > 0 && gain < kSettled * last && 1 / gain - inverse.shift() > kFarAbove * limit * limit;
      if (all_determined) break;
    }
    sortByInfluence(linearized, result);
    if (all_determined || count == dimension ||
        !(result.influence[count - 1] < std::max(limit, inverse.shift() > 0 ? kSeparated : 0)))
      return result;
    const Index next = std::min(4 * count, dimension);
    if (count >= kMostCount || static_cast<double>(diagonal.size() * next * next) > kMostWork) {
      result.may_miss_some = true;
      return result;
    }
    count = next;
  }
}

}  // namespace slom
