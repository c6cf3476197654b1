#include "slom/initialize/linear_relaxation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "mtk/error.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom::initialize {

double* LinearRelaxation::valueAt(int block) { return values_.data() + at(block) * at(rows_ * columns_); }
const double* LinearRelaxation::value(int block) const {
  return values_.data() + at(block) * at(rows_ * columns_);
}

void LinearRelaxation::addBlock(const double* value) {
  values_.resize(values_.size() + at(rows_ * columns_), 0.0);
  is_fixed_.push_back(value != nullptr ? 1 : 0);
  if (value != nullptr) std::copy(value, value + rows_ * columns_, values_.end() - rows_ * columns_);
}

void LinearRelaxation::add(double w, int i, int j, const double* M, const double* C) {
  if (!(w > 0 && std::isfinite(w))) {
    throw mtk::Error("slom.bad-information", "the mean information of an edge is " + number(w, 6) +
                                                 "; pass positive definite matrices");
  }
  terms_.push_back({w, i, j});
  M_.insert(M_.end(), M, M + rows_ * rows_);
  C_.insert(C_.end(), C, C + rows_ * columns_);
}

bool LinearRelaxation::solve() {
  using Eigen::Map;
  using Eigen::MatrixXd;
  BlockStructure structure;
  structure.offset.push_back(0);
  std::vector<int> block_of(is_fixed_.size(), -1);
  for (std::size_t k = 0; k < is_fixed_.size(); ++k) {
    if (is_fixed_[k] != 0) continue;
    block_of[k] = structure.blockCount();
    structure.offset.push_back(structure.offset.back() + rows_);
  }
  if (structure.unknowns() == 0) return true;

  MeasurementGroup group;
  group.arity = 2;
  std::vector<double> J;
  MatrixXd B = MatrixXd::Zero(structure.unknowns(), columns_);
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    const auto [w, i, j] = terms_[t];
    const int a = block_of[at(i)], b = block_of[at(j)];
    if (a < 0 && b < 0) continue;
    group.blocks.insert(group.blocks.end(), {a, b});
    const Map<const MatrixXd> M(M_.data() + t * at(rows_ * rows_), rows_, rows_);
    const Map<const MatrixXd> C(C_.data() + t * at(rows_ * columns_), rows_, columns_);
    const double root = std::sqrt(w);
    for (const double& m : M.reshaped()) J.push_back(-root * m);
    for (int c = 0; c < rows_; ++c) {
      for (int r = 0; r < rows_; ++r) J.push_back(r == c ? root : 0);
    }
    // The right-hand side, with the terms of fixed blocks moved to it.
    MatrixXd target = C;
    if (a < 0) target += M * Map<const MatrixXd>(valueAt(i), rows_, columns_);
    if (b < 0) target -= Map<const MatrixXd>(valueAt(j), rows_, columns_);
    if (a >= 0) B.middleRows(rows_ * a, rows_) -= w * M.transpose() * target;
    if (b >= 0) B.middleRows(rows_ * b, rows_) += w * target;
  }
  const std::vector<int> rows(at(group.size()), rows_), dof(group.blocks.size(), rows_);
  const std::vector<double> r(rows.size() * at(rows_), 0.0);
  structure.groups.push_back(std::move(group));

  BlockSolver solver({.method = BlockSolverOptions::Method::cholesky});
  solver.analyze(structure);
  solver.beginLinearization();
  if (!rows.empty())
    solver.add({0, 0, static_cast<int>(rows.size()), rows.data(), dof.data(), r.data(), J.data()});
  solver.endLinearization();
  MatrixXd X;
  if (!solver.solveFor(B, X).ok || !X.allFinite()) return false;
  for (std::size_t k = 0; k < is_fixed_.size(); ++k) {
    if (block_of[k] < 0) continue;
    Map<MatrixXd>(valueAt(static_cast<int>(k)), rows_, columns_) = X.middleRows(rows_ * block_of[k], rows_);
  }
  return true;
}

void detail::nearestRotation(int N, double* M) {
  if (N == 2) {
    const double angle = std::atan2(M[1] - M[2], M[0] + M[3]);
    M[0] = M[3] = std::cos(angle);
    M[1] = std::sin(angle);
    M[2] = -M[1];
    return;
  }
  Eigen::Map<Eigen::Matrix3d> R(M);
  const SVD svd = svdOf(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  R = svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

void detail::raiseUndetermined() {
  throw mtk::Error("slom.undetermined-start",
                   "the linear systems of chordal relaxation cannot be solved, because the weights of the "
                   "edges differ too much; start "
                   "along a spanning tree");
}

}  // namespace slom::initialize
