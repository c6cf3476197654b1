#include "slom/solve/block_qr.hpp"

#include "base/stopwatch.hpp"
#include "block/jacobian_rows.hpp"
#include "block/multifrontal_qr.hpp"
#include "symbolic/ordering.hpp"

namespace slom {

using Eigen::VectorXd;

struct BlockQR::Implementation {
  double pivot_tolerance = kPivotTolerance;
  BlockStructure structure;
  JacobianRows rows;
  MultifrontalQR factor;
  VectorXd gradient, diagonal, scale;
  bool has_undamped_factor = false;
  SolveStatus undamped_status;

  SolveStatus factorize(const VectorXd& damping) {
    const bool is_undamped = damping.size() == 0;
    if (is_undamped && has_undamped_factor) return undamped_status;
    scale = diagonal;
    if (!is_undamped) scale += damping;
    for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 1;
    const SolveStatus status = factor.factorize(rows, scale, damping, pivot_tolerance);
    has_undamped_factor = is_undamped;
    if (is_undamped) undamped_status = status;
    return status;
  }
};

BlockQR::BlockQR(double pivot_tolerance) : self_(new Implementation) {
  self_->pivot_tolerance = pivot_tolerance;
}
BlockQR::~BlockQR() = default;

double BlockQR::leastOfColumn() const { return self_->pivot_tolerance; }

void BlockQR::analyze(const BlockStructure& structure) {
  self_->structure = structure;
  self_->has_undamped_factor = false;
  self_->rows.analyze(self_->structure);
  self_->factor.analyze(self_->structure, chooseFronts(makeGraph(structure)));
}

void BlockQR::beginLinearization() {
  self_->rows.clear();
  self_->has_undamped_factor = false;
}
void BlockQR::add(const JacobianBatch& batch) { self_->rows.add(batch); }
void BlockQR::endLinearization() {
  self_->gradient = self_->rows.gradient();
  self_->diagonal = self_->rows.diagonal();
}

SolveStatus BlockQR::solve(const VectorXd& damping, VectorXd& step) {
  {
    const detail::Stopwatch watch(seconds_.factorize);
    const SolveStatus status = self_->factorize(damping);
    if (!status.ok) return status;
  }
  const detail::Stopwatch watch(seconds_.solve);
  step = self_->scale.cwiseProduct(self_->factor.solve());
  return {};
}

SolveStatus BlockQR::solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
  const SolveStatus status = self_->factorize({});
  if (!status.ok) return status;
  X.resize(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j) {
    X.col(j) = self_->scale.cwiseProduct(self_->factor.solveNormal(self_->scale.cwiseProduct(B.col(j))));
  }
  return status;
}

const VectorXd& BlockQR::gradient() const { return self_->gradient; }
const VectorXd& BlockQR::diagonal() const { return self_->diagonal; }
double BlockQR::squaredImage(const VectorXd& d) const { return self_->rows.squaredImage(d); }

std::string BlockQR::description() const {
  return "sparse QR, " + std::to_string(self_->rows.rows()) + " x " +
         std::to_string(self_->structure.unknowns()) + " in " +
         std::to_string(self_->structure.blockCount()) + " blocks, " + self_->factor.fronts().ordering +
         " order";
}

}  // namespace slom
