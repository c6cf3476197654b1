#include <algorithm>
#include <cholmod.h>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "block/normal_equations.hpp"
#include "slom/solve/cholmod.hpp"
#include "solve/named_list.hpp"
#include "symbolic/compact.hpp"

namespace slom {

using Eigen::VectorXd;

namespace {

/// Fraction of its diagonal entry below which a pivot is rounding error.
constexpr double kPivotTolerance = 1e-12;

class CholmodSolver final : public LinearSolver {
 public:
  CholmodSolver() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.quick_return_if_not_posdef = 1;
    common_.final_ll = 1;
  }
  ~CholmodSolver() override {
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  void analyze(const BlockStructure& now) override;
  void beginLinearization() override {
    equations_.setZero();
    has_undamped_factor_ = false;
  }
  void add(const JacobianBatch& batch) override { equations_.add(batch); }
  void endLinearization() override { equations_.addUp(); }
  SolveStatus solve(const VectorXd& damping, VectorXd& step) override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  const VectorXd& gradient() const override { return equations_.gradient(); }
  const VectorXd& diagonal() const override { return equations_.diagonal(); }
  double squaredNormOfJd(const VectorXd& d) const override { return equations_.squaredNormOfJd(d); }
  double leastOfColumn() const override { return std::sqrt(kPivotTolerance); }
  std::string description() const override {
    return "CHOLMOD, " +
           std::string(factor_ != nullptr && factor_->is_super != 0 ? "supernodal" : "simplicial") + ", " +
           std::to_string(structure_.unknowns()) + " unknowns";
  }

 private:
  void layOut();
  void fill(const VectorXd& damping);
  SolveStatus factorize(const VectorXd& damping);
  SolveStatus smallestPivot();
  VectorXd solved(const VectorXd& b);

  BlockStructure structure_;
  NormalEquations equations_;  // in the structure's order
  VectorXd scale_;
  std::vector<int> start_, row_;  // compressed columns of H's lower triangle, scaled to a unit diagonal
  std::vector<double> values_;
  cholmod_sparse A_{};
  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
  bool has_undamped_factor_ = false;
  SolveStatus undamped_status_;
};

void CholmodSolver::layOut() {
  const BlockLower& H = equations_.H();
  start_.assign(1, 0);
  row_.clear();
  for (int j = 0; j < H.columns(); ++j) {
    for (int c = 0; c < H.dof(j); ++c) {
      for (int k = H.begin(j); k < H.begin(j + 1); ++k) {
        const int i = H.row(k);
        for (int r = i == j ? c : 0; r < H.dof(i); ++r) row_.push_back(structure_.offset[at(i)] + r);
      }
      start_.push_back(static_cast<int>(row_.size()));
    }
  }
  values_.assign(row_.size(), 0.0);
  A_.nrow = A_.ncol = at(structure_.unknowns());
  A_.nzmax = row_.size();
  A_.p = start_.data();
  A_.i = row_.data();
  A_.x = values_.data();
  A_.stype = -1;
  A_.itype = CHOLMOD_INT;
  A_.xtype = CHOLMOD_REAL;
  A_.dtype = CHOLMOD_DOUBLE;
  A_.sorted = A_.packed = 1;
  cholmod_free_factor(&factor_, &common_);
  factor_ = cholmod_analyze(&A_, &common_);
}

void CholmodSolver::fill(const VectorXd& damping) {
  scale_ = equations_.diagonal();
  if (damping.size() > 0) scale_ += damping;
  for (double& s : scale_) s = s > 0 ? 1 / std::sqrt(s) : 1;
  const BlockLower& H = equations_.H();
  auto value = values_.begin();
  auto i = row_.begin();
  for (int j = 0; j < H.columns(); ++j) {
    for (int c = 0; c < H.dof(j); ++c) {
      const int column = structure_.offset[at(j)] + c;
      for (int k = H.begin(j); k < H.begin(j + 1); ++k) {
        const int height = H.dof(H.row(k));
        for (int r = H.row(k) == j ? c : 0; r < height; ++r, ++value, ++i) {
          double h = H.values(k)[c * height + r];
          if (*i == column && damping.size() > 0) h += damping[column];
          *value = h * scale_[*i] * scale_[column];
        }
      }
    }
  }
}

SolveStatus CholmodSolver::factorize(const VectorXd& damping) {
  const bool is_undamped = damping.size() == 0;
  if (is_undamped && has_undamped_factor_) return undamped_status_;
  fill(damping);
  cholmod_factorize(&A_, factor_, &common_);
  SolveStatus status;
  if (factor_->minor < factor_->n) {
    status = {false, static_cast<int*>(factor_->Perm)[factor_->minor], 0};
  } else if (cholmod_rcond(factor_, &common_) < kPivotTolerance) {
    status = smallestPivot();
  }
  has_undamped_factor_ = is_undamped;
  if (is_undamped) undamped_status_ = status;
  return status;
}

SolveStatus CholmodSolver::smallestPivot() {
  cholmod_factor* simple = cholmod_copy_factor(factor_, &common_);
  cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, simple, &common_);
  const int* const columns = static_cast<int*>(simple->p);
  const double* const L = static_cast<double*>(simple->x);
  SolveStatus status{false, -1, 1};
  for (std::size_t j = 0; j < simple->n; ++j) {
    const double pivot = L[columns[j]] * L[columns[j]];
    if (pivot < status.pivot) status = {false, static_cast<int*>(simple->Perm)[j], pivot};
  }
  cholmod_free_factor(&simple, &common_);
  return status.pivot < kPivotTolerance ? status : SolveStatus{};
}

VectorXd CholmodSolver::solved(const VectorXd& b) {
  VectorXd scaled = scale_.cwiseProduct(b);
  cholmod_dense right{};
  right.nrow = right.d = right.nzmax = static_cast<std::size_t>(scaled.size());
  right.ncol = 1;
  right.x = scaled.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &right, &common_);
  const VectorXd result =
      scale_.cwiseProduct(Eigen::Map<const VectorXd>(static_cast<const double*>(x->x), scaled.size()));
  cholmod_free_dense(&x, &common_);
  return result;
}

void CholmodSolver::analyze(const BlockStructure& now) {
  ++counts_.analyses;
  structure_ = compact(now).structure;
  has_undamped_factor_ = false;
  std::vector<int> position(at(structure_.blockCount()));
  std::iota(position.begin(), position.end(), 0);
  equations_.layOut(structure_, makeGraph(structure_), position);
  layOut();
}

SolveStatus CholmodSolver::solve(const VectorXd& damping, VectorXd& step) {
  {
    const detail::Stopwatch watch(seconds_.factorize);
    ++counts_.factorizations;
    const SolveStatus status = factorize(damping);
    if (!status.ok) return status;
  }
  const detail::Stopwatch watch(seconds_.solve);
  step = solved(-gradient());
  return {};
}

SolveStatus CholmodSolver::solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
  ++counts_.factorizations;
  const SolveStatus status = factorize({});
  if (!status.ok) return status;
  X.resize(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j) X.col(j) = solved(B.col(j));
  return status;
}

}  // namespace

bool Cholmod::isAvailable() { return true; }
Cholmod::Cholmod() : ForwardingSolver(std::make_unique<CholmodSolver>()) {}
std::unique_ptr<LinearSolver> Cholmod::makeAnother() const { return std::make_unique<Cholmod>(); }

const NamedSolver detail::solvers::cholmod{"cholmod", "CHOLMOD", &makeSolver<Cholmod>};

}  // namespace slom
