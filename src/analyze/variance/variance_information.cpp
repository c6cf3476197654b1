// Information on the logarithms of variance components.
#include <random>

#include "analyze/variance/variance_model.hpp"
#include "base/index.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kMostExactUnknowns = 400;  // for S: dense matrices of that size, one for each component
constexpr int kSigns = 64;               // probes of Hutchinson's estimator beyond
constexpr int kRoughSigns = 16;          // for an S that only directs a step

}  // namespace

bool VarianceModel::isExact() const { return structure_.unknowns() <= kMostExactUnknowns; }

/// Adds the information |(I - H)_kl|^2 = delta_kl (n_k - 2 tr H_kk) + |H_kl|^2.
void VarianceModel::addInformation(Evaluation& result, bool is_rough) {
  result.S = isExact() ? squaredLeverages() : squaredLeveragesByProbes(is_rough ? kRoughSigns : kSigns);
  result.S.diagonal() += 2 * result.redundancy - residuals_;
}

/// Returns |H_kl|^2 = tr(N_k C N_l C). N_k is the part of J^T J from component k.
MatrixXd VarianceModel::squaredLeverages() {
  const int unknowns = structure_.unknowns(), n = components();
  std::vector<MatrixXd> NC(at(n), MatrixXd::Zero(unknowns, unknowns));
  forEachOfComponents([&](std::size_t g, int m, int c) {
    rows_.forEachPart(g, m, [&](int a, const JacobianRows::Part& Ja) {
      rows_.forEachPart(g, m, [&](int b, const JacobianRows::Part& Jb) {
        NC[at(c)].block(structure_.offset[at(a)], structure_.offset[at(b)], Ja.cols(), Jb.cols()).noalias() +=
            Ja.transpose() * Jb;
      });
    });
  });
  MatrixXd C;
  static_cast<void>(solver_->solveFor(MatrixXd::Identity(unknowns, unknowns), C));
  for (MatrixXd& N : NC) N = (N * C).eval();
  MatrixXd result(n, n);
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l <= k; ++l)
      result(k, l) = result(l, k) = NC[at(k)].cwiseProduct(NC[at(l)].transpose()).sum();
  }
  return result;
}

/// Returns the mean of |J_k C J_l^T w|^2 over random signs w, for one l after the other.
///   source   Hutchinson, "A stochastic estimator of the trace of the influence matrix for Laplacian smoothing
///            splines", 1990
MatrixXd VarianceModel::squaredLeveragesByProbes(int count) {
  const int n = components();
  std::mt19937 engine(1);
  MatrixXd result = MatrixXd::Zero(n, n), X, signs, image;
  for (int l = 0; l < n; ++l) {
    MatrixXd B = MatrixXd::Zero(structure_.unknowns(), count);
    forEachOfComponents([&](std::size_t g, int m, int c) {
      if (c != l) return;
      signs.resize(rows_.residual(g, m).size(), count);
      for (Index i = 0; i < signs.size(); ++i) signs.data()[i] = (engine() & 1U) != 0 ? 1 : -1;
      rows_.forEachPart(g, m, [&](int a, const JacobianRows::Part& J) {
        B.middleRows(structure_.offset[at(a)], J.cols()).noalias() += J.transpose() * signs;
      });
    });
    static_cast<void>(solver_->solveFor(B, X));
    forEachOfComponents([&](std::size_t g, int m, int c) {
      image = MatrixXd::Zero(rows_.residual(g, m).size(), count);
      rows_.forEachPart(g, m, [&](int a, const JacobianRows::Part& J) {
        image.noalias() += J * X.middleRows(structure_.offset[at(a)], J.cols());
      });
      result(c, l) += image.squaredNorm();
    });
  }
  return (result + result.transpose()) / (2 * count);
}

}  // namespace slom
