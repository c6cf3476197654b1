#include "slom/solve/dense_qr.hpp"

#include "linearize/stopwatch.hpp"
#include "model/decompositions.hpp"

namespace slom {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns whose remaining norm is below this share of their own are combinations of the others.
constexpr double kRankTolerance = 1e-9;

struct Scaled {
  VectorXd scale;  // 1 / column norm, 1 for empty columns
  PivotedQR qr;
};

/// QR of A with columns scaled to unit length, so that units do not decide about the rank.
SolveStatus factorize(MatrixXd A, Scaled& result) {
  result.scale = A.colwise().norm();
  for (double& s : result.scale) s = s > 0 ? 1 / s : 1;
  A = A * result.scale.asDiagonal();
  const Eigen::Index n = A.cols();
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

}  // namespace

DenseQR::DenseQR() = default;
DenseQR::~DenseQR() = default;

void DenseQR::analyze(const BlockStructure& structure) { structure_ = structure; }

void DenseQR::beginLinearization() {
  rows_.clear();
  residual_.clear();
}

void DenseQR::add(const JacobianBatch& batch) {
  const int n = structure_.unknowns();
  const MeasurementGroup& group = structure_.groups[static_cast<std::size_t>(batch.group)];
  const double* J = batch.J;
  const double* r = batch.r;
  const int* dof = batch.dof;
  for (int m = 0; m < batch.count; ++m) {
    const int rows = batch.rows[m];
    MatrixXd full = MatrixXd::Zero(n, rows);  // transposed
    for (int k = 0; k < group.arity; ++k, ++dof) {
      const int block = group.blocks[static_cast<std::size_t>((batch.first + m) * group.arity + k)];
      if (block >= 0) {
        full.middleRows(structure_.offset[static_cast<std::size_t>(block)], *dof) +=
            Eigen::Map<const MatrixXd>(J, rows, *dof).transpose();
      }
      J += static_cast<std::ptrdiff_t>(rows) * *dof;
    }
    rows_.insert(rows_.end(), full.data(), full.data() + full.size());
    residual_.insert(residual_.end(), r, r + rows);
    r += rows;
  }
}

void DenseQR::endLinearization() {
  const Eigen::Index m = static_cast<Eigen::Index>(residual_.size()), n = structure_.unknowns();
  r_ = Eigen::Map<const VectorXd>(residual_.data(), m);
  J_ = Eigen::Map<const MatrixXd>(rows_.data(), n, m).transpose();
  gradient_ = J_.transpose() * r_;
  diagonal_ = J_.colwise().squaredNorm();
}

SolveStatus DenseQR::solve(const VectorXd& damping, VectorXd& step) {
  const detail::Stopwatch watch(seconds_.factorize);
  const Eigen::Index m = J_.rows(), n = J_.cols();
  const bool damped = damping.size() > 0;
  MatrixXd A = J_;
  VectorXd b = -r_;
  if (damped) {
    A.conservativeResize(m + n, n);
    A.bottomRows(n) = MatrixXd(damping.cwiseSqrt().asDiagonal());
    b.conservativeResize(m + n);
    b.tail(n).setZero();
  }
  Scaled scaled;
  const SolveStatus status = factorize(A, scaled);
  if (!status.ok) return status;
  if (b.size() < n) b.conservativeResizeLike(VectorXd::Zero(n));
  step = scaled.scale.asDiagonal() * slom::solve(scaled.qr, b);
  return {};
}

double DenseQR::squaredImage(const VectorXd& d) const { return (J_ * d).squaredNorm(); }

SolveStatus DenseQR::solveFor(const MatrixXd& B, MatrixXd& X) {
  Scaled scaled;
  const SolveStatus status = factorize(J_, scaled);
  if (!status.ok) return status;
  if (B.cols() == 0) {  // where Eigen's permutations go beyond a null pointer
    X = B;
    return {};
  }
  // H = S^-1 P R^T R P^T S^-1 with J S P = Q R.
  const Eigen::Index n = J_.cols();
  const auto R = scaled.qr.matrixQR().topLeftCorner(n, n).triangularView<Eigen::Upper>();
  MatrixXd Y = scaled.qr.colsPermutation().transpose() * (scaled.scale.asDiagonal() * B);
  Y = R.transpose().solve(Y);
  Y = R.solve(Y);
  X = scaled.scale.asDiagonal() * (scaled.qr.colsPermutation() * Y);
  return {};
}

std::string DenseQR::description() const {
  return "dense QR, " + std::to_string(J_.rows()) + " x " + std::to_string(J_.cols());
}

}  // namespace slom
