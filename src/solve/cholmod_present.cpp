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

/// A pivot below this share of its diagonal entry is rounding error.
constexpr double kPivotTolerance = 1e-12;

}  // namespace

struct Cholmod::Implementation {
  BlockStructure structure;
  NormalEquations equations;  // in the structure's order
  VectorXd scale;
  std::vector<int> start, row;  // of H's lower triangle, scaled to a unit diagonal, by columns
  std::vector<double> values;
  cholmod_sparse A{};
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  bool has_undamped_factor = false;
  SolveStatus undamped_status;

  Implementation() {
    cholmod_start(&common);
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
    common.final_ll = 1;
  }
  ~Implementation() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void layOut();
  void fill(const VectorXd& damping);
  SolveStatus factorize(const VectorXd& damping);
  SolveStatus smallestPivot();
  VectorXd solve(const VectorXd& b);
};

void Cholmod::Implementation::layOut() {
  const BlockLower& H = equations.H();
  start.assign(1, 0);
  row.clear();
  for (int j = 0; j < H.columns(); ++j) {
    for (int c = 0; c < H.dof(j); ++c) {
      for (int k = H.begin(j); k < H.begin(j + 1); ++k) {
        const int i = H.row(k);
        for (int r = i == j ? c : 0; r < H.dof(i); ++r) row.push_back(structure.offset[at(i)] + r);
      }
      start.push_back(static_cast<int>(row.size()));
    }
  }
  values.assign(row.size(), 0.0);
  A.nrow = A.ncol = at(structure.unknowns());
  A.nzmax = row.size();
  A.p = start.data();
  A.i = row.data();
  A.x = values.data();
  A.stype = -1;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_REAL;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  cholmod_free_factor(&factor, &common);
  factor = cholmod_analyze(&A, &common);
}

void Cholmod::Implementation::fill(const VectorXd& damping) {
  scale = equations.diagonal();
  if (damping.size() > 0) scale += damping;
  for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 1;
  const BlockLower& H = equations.H();
  auto value = values.begin();
  auto i = row.begin();
  for (int j = 0; j < H.columns(); ++j) {
    for (int c = 0; c < H.dof(j); ++c) {
      const int column = structure.offset[at(j)] + c;
      for (int k = H.begin(j); k < H.begin(j + 1); ++k) {
        const int height = H.dof(H.row(k));
        for (int r = H.row(k) == j ? c : 0; r < height; ++r, ++value, ++i) {
          double h = H.values(k)[c * height + r];
          if (*i == column && damping.size() > 0) h += damping[column];
          *value = h * scale[*i] * scale[column];
        }
      }
    }
  }
}

SolveStatus Cholmod::Implementation::factorize(const VectorXd& damping) {
  const bool is_undamped = damping.size() == 0;
  if (is_undamped && has_undamped_factor) return undamped_status;
  fill(damping);
  cholmod_factorize(&A, factor, &common);
  SolveStatus status;
  if (factor->minor < factor->n) {
    status = {false, static_cast<int*>(factor->Perm)[factor->minor], 0};
  } else if (cholmod_rcond(factor, &common) < kPivotTolerance) {
    status = smallestPivot();
  }
  has_undamped_factor = is_undamped;
  if (is_undamped) undamped_status = status;
  return status;
}

SolveStatus Cholmod::Implementation::smallestPivot() {
  cholmod_factor* simple = cholmod_copy_factor(factor, &common);
  cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, simple, &common);
  const int* const columns = static_cast<int*>(simple->p);
  const double* const L = static_cast<double*>(simple->x);
  SolveStatus status{false, -1, 1};
  for (std::size_t j = 0; j < simple->n; ++j) {
    const double pivot = L[columns[j]] * L[columns[j]];
    if (pivot < status.pivot) status = {false, static_cast<int*>(simple->Perm)[j], pivot};
  }
  cholmod_free_factor(&simple, &common);
  return status.pivot < kPivotTolerance ? status : SolveStatus{};
}

VectorXd Cholmod::Implementation::solve(const VectorXd& b) {
  VectorXd scaled = scale.cwiseProduct(b);
  cholmod_dense right{};
  right.nrow = right.d = right.nzmax = static_cast<std::size_t>(scaled.size());
  right.ncol = 1;
  right.x = scaled.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, &right, &common);
  const VectorXd result =
      scale.cwiseProduct(Eigen::Map<const VectorXd>(static_cast<const double*>(x->x), scaled.size()));
  cholmod_free_dense(&x, &common);
  return result;
}

bool Cholmod::isAvailable() { return true; }

Cholmod::Cholmod() : impl_(new Implementation) {}
Cholmod::~Cholmod() = default;
double Cholmod::leastOfColumn() const { return std::sqrt(kPivotTolerance); }

void Cholmod::analyze(const BlockStructure& structure) {
  ++counts_.analyses;
  impl_->structure = compact(structure).structure;
  impl_->has_undamped_factor = false;
  std::vector<int> position(at(impl_->structure.blockCount()));
  std::iota(position.begin(), position.end(), 0);
  impl_->equations.layOut(impl_->structure, makeGraph(impl_->structure), position);
  impl_->layOut();
}

void Cholmod::beginLinearization() {
  impl_->equations.setZero();
  impl_->has_undamped_factor = false;
}
void Cholmod::add(const JacobianBatch& batch) { impl_->equations.add(batch); }
void Cholmod::endLinearization() { impl_->equations.addUp(); }

SolveStatus Cholmod::solve(const VectorXd& damping, VectorXd& step) {
  {
    const detail::Stopwatch watch(seconds_.factorize);
    ++counts_.factorizations;
    const SolveStatus status = impl_->factorize(damping);
    if (!status.ok) return status;
  }
  const detail::Stopwatch watch(seconds_.solve);
  step = impl_->solve(-gradient());
  return {};
}

SolveStatus Cholmod::solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
  ++counts_.factorizations;
  const SolveStatus status = impl_->factorize({});
  if (!status.ok) return status;
  X.resize(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j) X.col(j) = impl_->solve(B.col(j));
  return status;
}

const VectorXd& Cholmod::gradient() const { return impl_->equations.gradient(); }
const VectorXd& Cholmod::diagonal() const { return impl_->equations.diagonal(); }
double Cholmod::squaredNormOfJd(const VectorXd& d) const { return impl_->equations.squaredNormOfJd(d); }

std::string Cholmod::description() const {
  return "CHOLMOD, " +
         std::string(impl_->factor != nullptr && impl_->factor->is_super != 0 ? "supernodal" : "simplicial") +
         ", " + std::to_string(impl_->structure.unknowns()) + " unknowns";
}

const NamedSolver detail::solvers::cholmod{"cholmod", "CHOLMOD", &makeSolver<Cholmod>};

}  // namespace slom
