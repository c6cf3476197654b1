#include "slom/solve/dense_qr.hpp"

#include "base/decompositions.hpp"
#include "base/stopwatch.hpp"
#include "solve/named_list.hpp"

namespace slom {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Fraction of a column's norm below which its remaining norm makes it a combination of the others.
constexpr double kRankTolerance = 1e-9;

}  // namespace

struct DenseQR::Implementation final : LinearSolver {
  struct ScaledQR {
    VectorXd scale;  // 1 / column norm; 1 for empty columns
    PivotedQR qr;

    /// Computes the QR of A with columns scaled to unit length, so that units do not affect the rank.
    SolveStatus factorize(MatrixXd A) {
      scale = A.colwise().norm();
      for (double& s : scale) s = s > 0 ? 1 / s : 1;
      A = A * scale.asDiagonal();
      const Eigen::Index n = A.cols();
      if (n == 0) return {};  // Eigen would search for the largest column
      if (A.rows() < n) A.conservativeResizeLike(MatrixXd::Zero(n, n));
      qr = pivotedQrOf(A);
      for (Eigen::Index i = 0; i < n; ++i) {
        const double pivot = std::abs(qr.matrixQR()(i, i));
        if (!(pivot > kRankTolerance)) {
          return {false, static_cast<int>(qr.colsPermutation().indices()[i]), pivot * pivot};
        }
      }
      return {};
    }
  };

  BlockStructure structure;
  MatrixXd J;
  VectorXd r, g, diagonal_of_H;
  std::vector<double> rows;      // row by row during collection
  std::vector<double> residual;  // row by row during collection
  ScaledQR factor;               // factor of J alone
  bool has_factor = false;
  SolveStatus status;

  void analyze(const BlockStructure& now) override {
    ++counts_.analyses;
    structure = now;
    has_factor = false;
  }

  void beginLinearization() override {
    has_factor = false;
    rows.clear();
    residual.clear();
  }

  void add(const JacobianBatch& batch) override {
    const int n = structure.unknowns();
    const MeasurementGroup& group = structure.groups[static_cast<std::size_t>(batch.group)];
    const double* blocks = batch.J;
    const double* residuals = batch.r;
    const int* dof = batch.dof;
    for (int m = 0; m < batch.count; ++m) {
      const int height = batch.rows[m];
      MatrixXd full = MatrixXd::Zero(n, height);  // transposed
      for (int k = 0; k < group.arity; ++k, ++dof) {
        const int block = group.blocks[static_cast<std::size_t>((batch.first + m) * group.arity + k)];
        if (block >= 0) {
          full.middleRows(structure.offset[static_cast<std::size_t>(block)], *dof) +=
              Eigen::Map<const MatrixXd>(blocks, height, *dof).transpose();
        }
        blocks += static_cast<std::ptrdiff_t>(height) * *dof;
      }
      rows.insert(rows.end(), full.data(), full.data() + full.size());
      residual.insert(residual.end(), residuals, residuals + height);
      residuals += height;
    }
  }

  void endLinearization() override {
    const Eigen::Index m = static_cast<Eigen::Index>(residual.size()), n = structure.unknowns();
    r = Eigen::Map<const VectorXd>(residual.data(), m);
    J = Eigen::Map<const MatrixXd>(rows.data(), n, m).transpose();
    g = J.transpose() * r;
    diagonal_of_H = J.colwise().squaredNorm();
  }

  SolveStatus solve(const VectorXd& damping, VectorXd& step) override {
    const detail::Stopwatch watch(seconds_.factorize);
    const Eigen::Index m = J.rows(), n = J.cols();
    const bool damped = damping.size() > 0;
    MatrixXd A = J;
    VectorXd b = -r;
    if (damped) {
      A.conservativeResize(m + n, n);
      A.bottomRows(n) = MatrixXd(damping.cwiseSqrt().asDiagonal());
      b.conservativeResize(m + n);
      b.tail(n).setZero();
    }
    ScaledQR own;
    if (damped) ++counts_.factorizations;
    const SolveStatus now = damped ? own.factorize(A) : factorizeUndamped();
    if (!now.ok) return now;
    const ScaledQR& scaled = damped ? own : factor;
    if (n == 0) {
      step.resize(0);
      return {};
    }
    if (b.size() < n) b.conservativeResizeLike(VectorXd::Zero(n));
    step = scaled.scale.asDiagonal() * leastSquares(scaled.qr, b);
    return {};
  }

  SolveStatus solveFor(const MatrixXd& B, MatrixXd& X) override {
    const SolveStatus now = factorizeUndamped();
    if (!now.ok) return now;
    if (B.size() == 0) {  // Eigen's permutations would step beyond a null pointer
      X = B;
      return {};
    }
    // H = S^-1 P R^T R P^T S^-1 with J S P = Q R.
    const Eigen::Index n = J.cols();
    const auto R = factor.qr.matrixQR().topLeftCorner(n, n).triangularView<Eigen::Upper>();
    MatrixXd Y = factor.qr.colsPermutation().transpose() * (factor.scale.asDiagonal() * B);
    Y = R.transpose().solve(Y);
    Y = R.solve(Y);
    X = factor.scale.asDiagonal() * (factor.qr.colsPermutation() * Y);
    return {};
  }

  const VectorXd& gradient() const override { return g; }
  const VectorXd& diagonal() const override { return diagonal_of_H; }
  double squaredNormOfJd(const VectorXd& d) const override { return (J * d).squaredNorm(); }
  double leastOfColumn() const override { return kRankTolerance; }
  std::string description() const override {
    return "dense QR, " + std::to_string(J.rows()) + " x " + std::to_string(J.cols());
  }

 private:
  SolveStatus factorizeUndamped() {
    if (has_factor) return status;
    ++counts_.factorizations;
    status = factor.factorize(J);
    has_factor = true;
    return status;
  }
};

DenseQR::DenseQR() : ForwardingSolver(std::make_unique<Implementation>()) {}

std::unique_ptr<LinearSolver> DenseQR::makeAnother() const { return std::make_unique<DenseQR>(); }

const MatrixXd& DenseQR::jacobian() const { return static_cast<const Implementation&>(solver()).J; }
const VectorXd& DenseQR::residual() const { return static_cast<const Implementation&>(solver()).r; }

const NamedSolver detail::solvers::dense_qr{"dense-qr", "dense QR decomposition, for small problems",
                                            &makeSolver<DenseQR>};

}  // namespace slom
