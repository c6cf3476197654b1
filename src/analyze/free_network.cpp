#include "analyze/free_network.hpp"

#include "analyze/null_space.hpp"
#include "base/decompositions.hpp"

namespace slom {

using Eigen::MatrixXd;

FreeNetwork::FreeNetwork(const LinearizedProblem& linearized)
    : structure_(linearized.structure().system),
      solver_(BlockSolverOptions{.method = BlockSolverOptions::Method::cholesky}) {
  for (const Finding& finding : linearized.diagnosis().findings) {
    if (finding.is_fault && finding.kind != Finding::Kind::gauge)
      throw Error("slom.rank-deficient", finding.text);
  }
  const double none = linearized.digitsOfDerivatives();
  const NearNullSpace& least = linearized.nearNullSpace();
  const MatrixXd null_space = least.direction.leftCols(least.countBelow(none));
  damping_ = Eigen::VectorXd::Zero(structure_.unknowns());
  N_ = MatrixXd(structure_.unknowns(), 0);
  if (null_space.cols() > 0) {
    const PivotedQR pivots = pivotedQrOf(null_space.transpose());
    for (Eigen::Index k = 0; k < null_space.cols(); ++k) {
      const int unknown = pivots.colsPermutation().indices()[k];
      damping_[unknown] = least.scale[unknown] * least.scale[unknown];
    }
    N_ = orthonormalBasis(least.scale.cwiseInverse().asDiagonal() * null_space);
  }
  solver_.analyze(structure_);
  linearized.rows().sendTo(solver_);
  SolveStatus status = solver_.solveDamped(damping_, N_, CN_);
  if (status.ok) status = solver_.invertDamped(damping_, damped_inverse_);
  if (!status.ok) throw linearized.undetermined(status);
  NCN_ = N_.transpose() * CN_;
}

MatrixXd FreeNetwork::rowsOf(const MatrixXd& A, int block) const {
  return A.middleRows(structure_.offset[static_cast<std::size_t>(block)], structure_.dof(block));
}

void FreeNetwork::block(int a, int b, double* out) const {
  Eigen::Map<MatrixXd> C(out, structure_.dof(a), structure_.dof(b));
  damped_inverse_->block(a, b, out);
  const MatrixXd Na = rowsOf(N_, a), Nb = rowsOf(N_, b);
  C += Na * NCN_ * Nb.transpose() - Na * rowsOf(CN_, b).transpose() - rowsOf(CN_, a) * Nb.transpose();
}

MatrixXd FreeNetwork::columns(int first, int count) const {
  MatrixXd unit = MatrixXd::Zero(structure_.unknowns(), count);
  unit.middleRows(first, count).setIdentity();
  return times(unit);
}

MatrixXd FreeNetwork::times(const MatrixXd& B) const {
  MatrixXd C;
  const MatrixXd orthogonal = B - N_ * (N_.transpose() * B);
  const SolveStatus status = solver_.solveDamped(damping_, orthogonal, C);
  if (!status.ok) throw Error("slom.rank-deficient", "the free network has no covariances");
  return C - N_ * (N_.transpose() * C);
}

}  // namespace slom
