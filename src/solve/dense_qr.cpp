#include "slom/solve/dense_qr.hpp"

#include "base/decompositions.hpp"
#include "base/stopwatch.hpp"
#include "solve/named_list.hpp"

namespace slom {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Columns whose remaining norm is below this share of their own are combinations of the others.
constexpr double kRankTolerance = 1e-9;

}  // namespace

struct DenseQR::Implementation {
  struct Scaled {
    VectorXd scale;  // 1 / column norm, 1 for empty columns
    PivotedQR qr;
  };

  /// QR of A with columns scaled to unit length, so that units do not decide about the rank.
  static SolveStatus factorize(MatrixXd A, Scaled& result) {
    result.scale = A.colwise().norm();
    for (double& s : result.scale) s = s > 0 ? 1 / s : 1;
    A = A * result.scale.asDiagonal();
    const Eigen::Index n = A.cols();
    if (n == 0) return {};  // Eigen looks for the largest of the columns
    if (A.rows() < n) A.conservativeResizeLike(MatrixXd::Zero(n, n));
    result.qr = pivotedQrOf(A);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double pivot = std::abs(result.qr.matrixQR()(i, i));
      if (!(pivot > kRankTolerance)) {
        return {false, static_cast<int>(result.qr.colsPermutation().indices()[i]), pivot * pivot};
      }
    }
    return {};
  }

  BlockStructure structure;
  MatrixXd J;
  VectorXd r, gradient, diagonal;
  std::vector<double> rows;      // row after row while they come in
  std::vector<double> residual;  // likewise
  Scaled factor;                 // of J alone
  bool has_factor = false;
  SolveStatus status;

  SolveStatus factorizeUndamped(SolverCounts& counts) {
    if (has_factor) return status;
    ++counts.factorizations;
    status = factorize(J, factor);
    has_factor = true;
    return status;
  }
};

DenseQR::DenseQR() : impl_(new Implementation) {}
DenseQR::~DenseQR() = default;

double DenseQR::leastOfColumn() const { return kRankTolerance; }

const VectorXd& DenseQR::gradient() const { return impl_->gradient; }
const VectorXd& DenseQR::diagonal() const { return impl_->diagonal; }
const MatrixXd& DenseQR::jacobian() const { return impl_->J; }
const VectorXd& DenseQR::residual() const { return impl_->r; }

void DenseQR::analyze(const BlockStructure& structure) {
  ++counts_.analyses;
  impl_->structure = structure;
  impl_->has_factor = false;
}

void DenseQR::beginLinearization() {
  impl_->has_factor = false;
  impl_->rows.clear();
  impl_->residual.clear();
}

void DenseQR::add(const JacobianBatch& batch) {
  const int n = impl_->structure.unknowns();
  const MeasurementGroup& group = impl_->structure.groups[static_cast<std::size_t>(batch.group)];
  const double* J = batch.J;
  const double* r = batch.r;
  const int* dof = batch.dof;
  for (int m = 0; m < batch.count; ++m) {
    const int rows = batch.rows[m];
    MatrixXd full = MatrixXd::Zero(n, rows);  // transposed
    for (int k = 0; k < group.arity; ++k, ++dof) {
      const int block = group.blocks[static_cast<std::size_t>((batch.first + m) * group.arity + k)];
      if (block >= 0) {
        full.middleRows(impl_->structure.offset[static_cast<std::size_t>(block)], *dof) +=
            Eigen::Map<const MatrixXd>(J, rows, *dof).transpose();
      }
      J += static_cast<std::ptrdiff_t>(rows) * *dof;
    }
    impl_->rows.insert(impl_->rows.end(), full.data(), full.data() + full.size());
    impl_->residual.insert(impl_->residual.end(), r, r + rows);
    r += rows;
  }
}

void DenseQR::endLinearization() {
  const Eigen::Index m = static_cast<Eigen::Index>(impl_->residual.size()), n = impl_->structure.unknowns();
  impl_->r = Eigen::Map<const VectorXd>(impl_->residual.data(), m);
  impl_->J = Eigen::Map<const MatrixXd>(impl_->rows.data(), n, m).transpose();
  impl_->gradient = impl_->J.transpose() * impl_->r;
  impl_->diagonal = impl_->J.colwise().squaredNorm();
}

SolveStatus DenseQR::solve(const VectorXd& damping, VectorXd& step) {
  const detail::Stopwatch watch(seconds_.factorize);
  const Eigen::Index m = impl_->J.rows(), n = impl_->J.cols();
  const bool damped = damping.size() > 0;
  MatrixXd A = impl_->J;
  VectorXd b = -impl_->r;
  if (damped) {
    A.conservativeResize(m + n, n);
    A.bottomRows(n) = MatrixXd(damping.cwiseSqrt().asDiagonal());
    b.conservativeResize(m + n);
    b.tail(n).setZero();
  }
  Implementation::Scaled own;
  if (damped) ++counts_.factorizations;
  const SolveStatus status = damped ? Implementation::factorize(A, own) : impl_->factorizeUndamped(counts_);
  if (!status.ok) return status;
  const Implementation::Scaled& scaled = damped ? own : impl_->factor;
  if (n == 0) {
    step.resize(0);
    return {};
  }
  if (b.size() < n) b.conservativeResizeLike(VectorXd::Zero(n));
  step = scaled.scale.asDiagonal() * leastSquares(scaled.qr, b);
  return {};
}

double DenseQR::squaredNormOfJd(const VectorXd& d) const { return (impl_->J * d).squaredNorm(); }

SolveStatus DenseQR::solveFor(const MatrixXd& B, MatrixXd& X) {
  const SolveStatus status = impl_->factorizeUndamped(counts_);
  if (!status.ok) return status;
  const Implementation::Scaled& scaled = impl_->factor;
  if (B.size() == 0) {  // where Eigen's permutations go beyond a null pointer
    X = B;
    return {};
  }
  // H = S^-1 P R^T R P^T S^-1 with J S P = Q R.
  const Eigen::Index n = impl_->J.cols();
  const auto R = scaled.qr.matrixQR().topLeftCorner(n, n).triangularView<Eigen::Upper>();
  MatrixXd Y = scaled.qr.colsPermutation().transpose() * (scaled.scale.asDiagonal() * B);
  Y = R.transpose().solve(Y);
  Y = R.solve(Y);
  X = scaled.scale.asDiagonal() * (scaled.qr.colsPermutation() * Y);
  return {};
}

std::string DenseQR::description() const {
  return "dense QR, " + std::to_string(impl_->J.rows()) + " x " + std::to_string(impl_->J.cols());
}

const NamedSolver detail::solvers::dense_qr{"dense-qr", "a dense one, for small problems",
                                            &makeSolver<DenseQR>};

}  // namespace slom
