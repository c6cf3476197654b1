#include "slom/solve/block_qr.hpp"

#include "base/stopwatch.hpp"
#include "block/jacobian_rows.hpp"
#include "block/multifrontal_qr.hpp"
#include "solve/named_list.hpp"
#include "symbolic/compact.hpp"
#include "symbolic/ordering.hpp"

namespace slom {

using Eigen::VectorXd;

namespace {

class SparseQR final : public LinearSolver {
 public:
  explicit SparseQR(double pivot_tolerance) : pivot_tolerance_(pivot_tolerance) {}
  double pivotTolerance() const { return pivot_tolerance_; }

  void analyze(const BlockStructure& structure) override {
    ++counts_.analyses;
    structure_ = compact(structure).structure;
    has_undamped_factor_ = false;
    rows_.analyze(structure_);
    factor_.analyze(structure_, chooseFronts(makeGraph(structure_)));
  }

  void beginLinearization() override {
    rows_.clear();
    has_undamped_factor_ = false;
  }
  void add(const JacobianBatch& batch) override { rows_.add(batch); }
  void endLinearization() override {
    gradient_ = rows_.gradient();
    diagonal_ = rows_.diagonal();
  }

  SolveStatus solve(const VectorXd& damping, VectorXd& step) override {
    {
      const detail::Stopwatch watch(seconds_.factorize);
      const SolveStatus status = factorize(damping);
      if (!status.ok) return status;
    }
    const detail::Stopwatch watch(seconds_.solve);
    step = scale_.cwiseProduct(factor_.solve());
    return {};
  }

  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override {
    const SolveStatus status = factorize({});
    if (!status.ok) return status;
    X.resize(B.rows(), B.cols());
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      X.col(j) = scale_.cwiseProduct(factor_.solveNormal(scale_.cwiseProduct(B.col(j))));
    }
    return status;
  }

  const VectorXd& gradient() const override { return gradient_; }
  const VectorXd& diagonal() const override { return diagonal_; }
  double squaredNormOfJd(const VectorXd& d) const override { return rows_.squaredNormOfJd(d); }
  double leastOfColumn() const override { return pivot_tolerance_; }

  std::string description() const override {
    return "sparse QR, " + std::to_string(rows_.rows()) + " x " + std::to_string(structure_.unknowns()) +
           " in " + std::to_string(structure_.blockCount()) + " blocks, " + factor_.fronts().ordering +
           " order";
  }

 private:
  SolveStatus factorize(const VectorXd& damping) {
    const bool is_undamped = damping.size() == 0;
    if (is_undamped && has_undamped_factor_) return undamped_status_;
    ++counts_.factorizations;
    scale_ = diagonal_;
    if (!is_undamped) scale_ += damping;
    for (double& s : scale_) s = s > 0 ? 1 / std::sqrt(s) : 1;
    const SolveStatus status = factor_.factorize(rows_, scale_, damping, pivot_tolerance_);
    has_undamped_factor_ = is_undamped;
    if (is_undamped) undamped_status_ = status;
    return status;
  }

  double pivot_tolerance_;
  BlockStructure structure_;
  JacobianRows rows_;
  MultifrontalQR factor_;
  VectorXd gradient_, diagonal_, scale_;
  bool has_undamped_factor_ = false;
  SolveStatus undamped_status_;
};

}  // namespace

BlockQR::BlockQR(double pivot_tolerance) : ForwardingSolver(std::make_unique<SparseQR>(pivot_tolerance)) {}

std::unique_ptr<LinearSolver> BlockQR::makeAnother() const {
  return std::make_unique<BlockQR>(static_cast<const SparseQR&>(solver()).pivotTolerance());
}

const NamedSolver detail::solvers::block_qr{"qr", "QR decomposition of J, for ill-conditioned problems",
                                            &makeSolver<BlockQR>};

}  // namespace slom
