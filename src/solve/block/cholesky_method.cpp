#include "cholesky_method.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/threads.hpp"

namespace slom {

using Eigen::VectorXd;

namespace {

/// Blocks of the inverse at the places of H's blocks: those of eliminated columns, and those of the reduced system.
class SelectedInverse final : public InverseBlocks {
 public:
  SelectedInverse(std::vector<int> position, int count) : position_(std::move(position)), count_(count) {}
  BlockLower eliminated, kept;

  void block(int a, int b, double* out) const override {
    const int i = position_[at(a)], j = position_[at(b)], low = std::min(i, j), high = std::max(i, j);
    const BlockLower& from = low < count_ ? eliminated : kept;
    const int shift = low < count_ ? 0 : count_, rows = from.dof(high - shift),
              columns = from.dof(low - shift);
    const Eigen::Map<const Eigen::MatrixXd> values(from.values(from.find(high - shift, low - shift)), rows,
                                                   columns);
    if (i == j) {
      Eigen::Map<Eigen::MatrixXd>(out, rows, columns) = (values + values.transpose()) / 2;
    } else if (i > j) {
      Eigen::Map<Eigen::MatrixXd>(out, rows, columns) = values;
    } else {
      Eigen::Map<Eigen::MatrixXd>(out, columns, rows) = values.transpose();
    }
  }

 private:
  std::vector<int> position_;
  int count_;
};

}  // namespace

CholeskyMethod::CholeskyMethod(std::string system, const BlockStructure& structure,
                               const NormalEquations& equations, std::unique_ptr<Elimination> elimination,
                               const std::vector<int>& rest, Fronts fronts)
    : system_(std::move(system)), equations_(equations), elimination_(std::move(elimination)) {
  for (int b = 0; b < structure.blockCount(); ++b) position_.push_back(equations.position(b));
  std::vector<int> offset{0};
  for (const int b : rest) {
    for (int c = 0; elimination_ && c < structure.dof(b); ++c) kept_.push_back(structure.offset[at(b)] + c);
    offset.push_back(offset.back() + structure.dof(b));
  }
  factor_.analyze(offset, std::move(fronts), matrix());
}

VectorXd CholeskyMethod::kept(const VectorXd& x) const {
  return x.size() == 0 ? VectorXd() : VectorXd(x(kept_));
}

SolveStatus CholeskyMethod::factorize(const VectorXd& damping, VectorXd* x) {
  const BlockLower& H = equations_.H();
  if (!elimination_) return factor_.factorize(H, equations_.diagonal(), damping, kPivotTolerance, x);
  SolveStatus status = elimination_->reduce(H, equations_.offset(), damping, kPivotTolerance, x);
  if (!status.ok) return status;
  VectorXd rest;
  if (x != nullptr) rest = kept(*x);
  status = factor_.factorize(matrix(), kept(equations_.diagonal()), kept(damping), kPivotTolerance,
                             x != nullptr ? &rest : nullptr);
  if (!status.ok) status.unknown = kept_[at(status.unknown)];
  return status;
}

/// Solves for the right-hand side in the fronts. If blocks are eliminated, x holds their part of it.
void CholeskyMethod::backSolve(VectorXd& x) {
  if (!elimination_) {
    x = factor_.backSolve();
    return;
  }
  x(kept_) = factor_.backSolve();
  elimination_->substitute(equations_.H(), equations_.offset(), x);
}

SolveStatus CholeskyMethod::solve(VectorXd& x) {
  if (elimination_) elimination_->forward(equations_.H(), equations_.offset(), x);
  factor_.forwardSolve(elimination_ ? kept(x) : x);
  backSolve(x);
  return {};
}

void CholeskyMethod::solveAlone(VectorXd& x, MultifrontalCholesky::Workspace& workspace) const {
  if (!elimination_) {
    x = factor_.solveAlone(x, workspace);
    return;
  }
  elimination_->forward(equations_.H(), equations_.offset(), x);
  x(kept_) = factor_.solveAlone(kept(x), workspace);
  elimination_->substitute(equations_.H(), equations_.offset(), x);
}

/// Solves a part of the columns on each thread. If there are fewer columns than threads, all threads solve each column.
SolveStatus CholeskyMethod::solveColumns(Eigen::MatrixXd& X) {
  const int columns = static_cast<int>(X.cols()), parts = detail::threadCount();
  if (parts < 2 || columns < parts) return BlockMethod::solveColumns(X);
  detail::forEachIndex(parts, [&](int part) {
    MultifrontalCholesky::Workspace workspace;
    VectorXd x;
    for (int j = part; j < columns; j += parts) {
      x = X.col(j);
      solveAlone(x, workspace);
      X.col(j) = x;
    }
  });
  return {};
}

SolveStatus CholeskyMethod::finishStep(VectorXd& x, bool is_forward_solved) {
  if (!is_forward_solved) return solve(x);
  backSolve(x);
  return {};
}

std::unique_ptr<InverseBlocks> CholeskyMethod::invertBlocks() {
  auto result = std::make_unique<SelectedInverse>(position_, elimination_ ? elimination_->count() : 0);
  result->kept.layOutAs(matrix());
  factor_.invertSelected(result->kept);
  if (elimination_) {
    result->eliminated.layOutAs(equations_.H());
    elimination_->invert(equations_.H(), result->kept, result->eliminated);
  }
  return result;
}

double CholeskyMethod::flops() const {
  return factor_.fronts().flops + (elimination_ ? elimination_->flops() : 0);
}

std::string CholeskyMethod::description() const {
  const Fronts& fronts = factor_.fronts();
  const std::string first = elimination_ ? elimination_->description() : "";
  if (first.empty() && fronts.front.empty()) return system_ + ", without unknowns";
  if (first.empty() && fronts.front.size() == 1) return system_ + ", dense Cholesky";
  std::string text = system_ + ", sparse Cholesky, " + first;
  if (!first.empty() && !fronts.front.empty()) text += ", then ";
  return fronts.front.empty() ? text : text + fronts.ordering + " order";
}

}  // namespace slom
