#include "slom/solve/block_qr.hpp"

#include "base/stopwatch.hpp"
#include "block/jacobian_rows.hpp"
#include "block/multifrontal_qr.hpp"
#include "solve/named_list.hpp"
#include "symbolic/compact.hpp"
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

  SolveStatus factorize(const VectorXd& damping, SolverCounts& counts) {
    const bool is_undamped = damping.size() == 0;
    if (is_undamped && has_undamped_factor) return undamped_status;
    ++counts.factorizations;
    scale = diagonal;
    if (!is_undamped) scale += damping;
    for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 1;
    const SolveStatus status = factor.factorize(rows, scale, damping, pivot_tolerance);
    has_undamped_factor = is_undamped;
    if (is_undamped) undamped_status = status;
    return status;
  }
};

BlockQR::BlockQR(double pivot_tolerance) : impl_(new Implementation) {
  impl_->pivot_tolerance = pivot_tolerance;
}
BlockQR::~BlockQR() = default;

double BlockQR::leastOfColumn() const { return impl_->pivot_tolerance; }

void BlockQR::analyze(const BlockStructure& structure) {
  ++counts_.analyses;
  impl_->structure = compact(structure).structure;
  impl_->has_undamped_factor = false;
  impl_->rows.analyze(impl_->structure);
  impl_->factor.analyze(impl_->structure, chooseFronts(makeGraph(impl_->structure)));
}

void BlockQR::beginLinearization() {
  impl_->rows.clear();
  impl_->has_undamped_factor = false;
}
void BlockQR::add(const JacobianBatch& batch) { impl_->rows.add(batch); }
void BlockQR::endLinearization() {
  impl_->gradient = impl_->rows.gradient();
  impl_->diagonal = impl_->rows.diagonal();
}

SolveStatus BlockQR::solve(const VectorXd& damping, VectorXd& step) {
  {
    const detail::Stopwatch watch(seconds_.factorize);
    const SolveStatus status = impl_->factorize(damping, counts_);
    if (!status.ok) return status;
  }
  const detail::Stopwatch watch(seconds_.solve);
  step = impl_->scale.cwiseProduct(impl_->factor.solve());
  return {};
}

SolveStatus BlockQR::solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
  const SolveStatus status = impl_->factorize({}, counts_);
  if (!status.ok) return status;
  X.resize(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j) {
    X.col(j) = impl_->scale.cwiseProduct(impl_->factor.solveNormal(impl_->scale.cwiseProduct(B.col(j))));
  }
  return status;
}

const VectorXd& BlockQR::gradient() const { return impl_->gradient; }
const VectorXd& BlockQR::diagonal() const { return impl_->diagonal; }
double BlockQR::squaredNormOfJd(const VectorXd& d) const { return impl_->rows.squaredNormOfJd(d); }

std::string BlockQR::description() const {
  return "sparse QR, " + std::to_string(impl_->rows.rows()) + " x " +
         std::to_string(impl_->structure.unknowns()) + " in " +
         std::to_string(impl_->structure.blockCount()) + " blocks, " + impl_->factor.fronts().ordering +
         " order";
}

const NamedSolver detail::solvers::block_qr{"qr", "QR decomposition of J, for ill-conditioned problems",
                                            &makeSolver<BlockQR>};

}  // namespace slom
