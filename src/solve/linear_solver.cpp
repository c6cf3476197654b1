#include "slom/solve/linear_solver.hpp"

#include <algorithm>

namespace slom {

namespace {

class WholeInverse final : public InverseBlocks {
 public:
  WholeInverse(std::vector<int> offset, Eigen::MatrixXd inverse)
      : offset_(std::move(offset)), inverse_(std::move(inverse)) {}
  void block(int a, int b, double* out) const override {
    for (int j = begin(b); j < begin(b + 1); ++j) {
      for (int i = begin(a); i < begin(a + 1); ++i) *out++ = (inverse_(i, j) + inverse_(j, i)) / 2;
    }
  }

 private:
  int begin(int block) const { return offset_[static_cast<std::size_t>(block)]; }
  std::vector<int> offset_;
  Eigen::MatrixXd inverse_;
};

}  // namespace

std::unique_ptr<LinearSolver> LinearSolver::careful(double) const { return nullptr; }

std::unique_ptr<LinearSolver> LinearSolver::makeAnother() const { return nullptr; }

SolveStatus LinearSolver::invertBlocks(const BlockStructure& structure,
                                       std::unique_ptr<InverseBlocks>& blocks) {
  const Eigen::Index n = structure.unknowns();
  Eigen::MatrixXd inverse;
  const SolveStatus status = solveFor(Eigen::MatrixXd::Identity(n, n), inverse);
  if (status.ok) blocks = std::make_unique<WholeInverse>(structure.offset, std::move(inverse));
  return status;
}

}  // namespace slom
