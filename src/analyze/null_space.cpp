#include "analyze/null_space.hpp"

#include <algorithm>
#include <cmath>

#include "model/decompositions.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDamping = 1e-10;  // of the scaled J^T J, whose diagonal is 1
constexpr int kIterations = 6;
/// The iteration tells directions apart whose squared influence differs by more than the damping: a long chain has many that are
/// nearly free.
constexpr double kSeparated = 3e-5;
constexpr Index kFirstCount = 12, kMostCount = 192;
/// Of unknowns x directions^2, which the time goes with: some ten seconds.
constexpr double kMostWork = 1e9;

/// Squared lengths of columns, 0 for those that are nothing but rounding errors: beside the largest column of the same variable,
/// whose components may differ in unit, but hardly by this. A component that no residual depends on often has such a column, as the
/// translation t in (R - I) t along the axis of R.
VectorXd withoutRounding(VectorXd diagonal, const BlockStructure& structure) {
  constexpr double rounding = 1e-14;
  for (int b = 0; b < structure.blockCount(); ++b) {
    auto own = diagonal.segment(structure.offset[static_cast<std::size_t>(b)], structure.dof(b));
    const double limit = rounding * rounding * own.maxCoeff();
    for (double& h : own) h = h < limit ? 0 : h;
  }
  return diagonal;
}

/// Numbers that look random and are the same in every run, 0 for idle unknowns.
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

/// Turns the columns of `result.direction` into the singular vectors of J among them.
void sortByInfluence(const StoredJacobian& jacobian, LeastInfluence& result) {
  MatrixXd image = jacobian.times(result.scale.cwiseInverse().asDiagonal() * result.direction);
  if (image.rows() > image.cols()) {
    triangularize(image);
    image = MatrixXd(image.topRows(image.cols()).triangularView<Eigen::Upper>());
  }
  const SVD svd = svdOf(image, Eigen::ComputeFullV);
  const Index count = result.direction.cols();
  result.influence.setZero(count);
  for (Index k = 0; k < svd.singularValues().size(); ++k) result.influence[count - 1 - k] = svd.singularValues()[k];
  result.direction = result.direction * svd.matrixV().rowwise().reverse();
}

}  // namespace

LeastInfluence leastInfluence(const StoredJacobian& jacobian, const BlockStructure& structure, Problem& problem,
                              Linearizer& linearizer, double limit) {
  LeastInfluence result;
  const VectorXd diagonal = withoutRounding(jacobian.rows().diagonal(), structure);
  result.scale = diagonal.unaryExpr([](double h) { return h > 0 ? std::sqrt(h) : 1.0; });
  for (Index i = 0; i < diagonal.size(); ++i) {
    if (!(diagonal[i] > 0)) result.idle.push_back(static_cast<int>(i));
  }
  const Index dimension = diagonal.size() - static_cast<Index>(result.idle.size());
  if (dimension == 0) {
    result.direction.resize(diagonal.size(), 0);
    return result;
  }
  BlockSolver solver(BlockSolverOptions{.method = BlockSolverOptions::Method::cholesky});
  solver.analyze(structure);
  linearizer.linearize(problem, solver);
  VectorXd damping = kDamping * result.scale.cwiseAbs2();
  for (const int i : result.idle) damping[i] = 1;
  for (Index count = std::min(kFirstCount, dimension);;) {
    result.direction = orthonormalBasis(startVectors(diagonal, count));
    for (int i = 0; i < kIterations; ++i) {
      MatrixXd moved;
      const SolveStatus status = solver.solveDamped(damping, result.scale.asDiagonal() * result.direction, moved);
      if (!status.ok) break;  // the vectors so far are the best there are
      for (const int i : result.idle) moved.row(i).setZero();
      result.direction = orthonormalBasis(result.scale.asDiagonal() * moved);
    }
    sortByInfluence(jacobian, result);
    if (count == dimension || !(result.influence[count - 1] < std::max(limit, kSeparated))) return result;
    const Index next = std::min(4 * count, dimension);
    if (count >= kMostCount || static_cast<double>(diagonal.size() * next * next) > kMostWork) {
      result.may_miss_some = true;
      return result;
    }
    count = next;
  }
}

}  // namespace slom
