#include "reduced_operator.hpp"

#include <Eigen/Cholesky>

#include "base/index.hpp"
#include "base/threads.hpp"

namespace slom {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Block = Eigen::Map<const MatrixXd>;
using Part = Eigen::Map<VectorXd>;
using ConstPart = Eigen::Map<const VectorXd>;

constexpr int kPowerSeriesTerms = 3;
constexpr int kColumnsPerTask = 256;

}  // namespace

void ReducedOperator::analyze(const BlockLower& H, int eliminated, Preconditioner preconditioner) {
  eliminated_.analyze(H, eliminated);
  start_.assign(1, 0);
  for (int j = eliminated; j < H.columns(); ++j) start_.push_back(start_.back() + H.dof(j));
  eliminated_start_.assign(1, 0);
  for (int e = 0; e < eliminated; ++e) eliminated_start_.push_back(eliminated_start_.back() + at(H.dof(e)));
  images_.assign(eliminated_start_.back(), 0.0);
  first_.assign(at(left()) + 1, 0);
  bool meet = false;
  for (int j = 0; j < H.columns(); ++j) {
    for (int k = H.begin(j) + 1; k < H.begin(j + 1); ++k) ++first_[at(H.row(k) - eliminated) + 1];
    meet = meet || (j >= eliminated && H.begin(j + 1) > H.begin(j) + 1);
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  neighbours_.resize(at(first_.back()));
  std::vector<int> next = first_;
  for (int j = 0; j < H.columns(); ++j) {
    for (int k = H.begin(j) + 1; k < H.begin(j + 1); ++k)
      neighbours_[at(next[at(H.row(k) - eliminated)]++)] = {k, j};
  }
  const bool diverges = preconditioner == Preconditioner::power_series && (meet || eliminated == 0);
  preconditioner_ = diverges ? Preconditioner::schur_jacobi : preconditioner;
  diagonal_.resize(at(left()));
  inverse_.resize(at(left()));
}

SolveStatus ReducedOperator::prepareProducts(const BlockLower& H, const std::vector<int>& offset,
                                             const VectorXd& damping, double tolerance) {
  H_ = &H;
  const SolveStatus status = eliminated_.factorizeAll(H, offset, damping, tolerance);
  if (!status.ok) return status;
  for (int c = 0; c < left(); ++c) {
    const int j = eliminated_.count() + c;
    diagonal_[at(c)] = Block(H.values(H.begin(j)), dof(c), dof(c));
    if (damping.size() > 0) diagonal_[at(c)].diagonal() += damping.segment(offset[at(j)], dof(c));
  }
  return status;
}

SolveStatus ReducedOperator::prepare(const BlockLower& H, const std::vector<int>& offset,
                                     const VectorXd& damping, double tolerance) {
  const SolveStatus status = prepareProducts(H, offset, damping, tolerance);
  if (!status.ok) return status;
  detail::forEachIndex(left(), [&](int c) { prepareRow(c); });
  for (int c = 0; c < left(); ++c) {
    if (inverse_[at(c)].size() == 0) return {false, offset[at(eliminated_.count() + c)], 0};
  }
  return {};
}

MatrixXd ReducedOperator::diagonalBlock(int c) const {
  MatrixXd M = diagonal_[at(c)];
  if (preconditioner_ != Preconditioner::schur_jacobi) return M;
  const int height = dof(c);
  MatrixXd Y;
  for (int n = first_[at(c)]; n < first_[at(c) + 1]; ++n) {
    const auto [block, e] = neighbours_[at(n)];
    if (e >= eliminated_.count()) continue;
    Y = Block(H_->values(block), height, H_->dof(e)).transpose();
    for (int i = 0; i < height; ++i) eliminated_.forward(e, H_->dof(e), Y.col(i).data());
    M.noalias() -= Y.transpose().lazyProduct(Y);
  }
  return M;
}

/// Prepares the preconditioner's block. Leaves inverse_ empty if the block is not positive definite.
void ReducedOperator::prepareRow(int c) {
  const Eigen::LLT<MatrixXd> factor(diagonalBlock(c));
  if (factor.info() == Eigen::Success) {
    inverse_[at(c)] = factor.solve(MatrixXd::Identity(dof(c), dof(c)));
  } else {
    inverse_[at(c)].resize(0, 0);
  }
}

void ReducedOperator::multiply(const VectorXd& x, VectorXd& y) {
  const int count = eliminated_.count();
  const auto part = [&](int j) { return ConstPart(x.data() + start_[at(j - count)], H_->dof(j)); };
  detail::forEachIndex((count + kColumnsPerTask - 1) / kColumnsPerTask, [&](int task) {
    for (int e = task * kColumnsPerTask; e < std::min(count, (task + 1) * kColumnsPerTask); ++e) {
      const int d = H_->dof(e);
      Part t(images_.data() + eliminated_start_[at(e)], d);
      t.setZero();
      for (int k = H_->begin(e) + 1; k < H_->begin(e + 1); ++k) {
        t.noalias() -= Block(H_->values(k), H_->dof(H_->row(k)), d).transpose().lazyProduct(part(H_->row(k)));
      }
      eliminated_.forward(e, d, t.data());
      eliminated_.backward(e, d, t.data());
    }
  });
  y.resize(size());
  detail::forEachIndex(left(), [&](int c) {
    const int j = count + c, height = dof(c);
    Part out(y.data() + start_[at(c)], height);
    out.noalias() = diagonal_[at(c)].lazyProduct(part(j));
    for (int k = H_->begin(j) + 1; k < H_->begin(j + 1); ++k) {
      out.noalias() +=
          Block(H_->values(k), H_->dof(H_->row(k)), height).transpose().lazyProduct(part(H_->row(k)));
    }
    for (int n = first_[at(c)]; n < first_[at(c) + 1]; ++n) {
      const auto [block, column] = neighbours_[at(n)];
      const int width = H_->dof(column);
      const double* const from = column < count ? images_.data() + eliminated_start_[at(column)]
                                                : x.data() + start_[at(column - count)];
      out.noalias() += Block(H_->values(block), height, width).lazyProduct(ConstPart(from, width));
    }
  });
}

void ReducedOperator::applyDiagonal(const VectorXd& r, VectorXd& z) const {
  z.resize(size());
  for (int c = 0; c < left(); ++c) {
    Part(z.data() + start_[at(c)], dof(c)).noalias() =
        inverse_[at(c)].lazyProduct(ConstPart(r.data() + start_[at(c)], dof(c)));
  }
}

void ReducedOperator::precondition(const VectorXd& r, VectorXd& z) {
  applyDiagonal(r, z);
  if (preconditioner_ != Preconditioner::power_series) return;
  // With S = D - E: S^-1 = sum_i (D^-1 E)^i D^-1 and D^-1 E t = t - D^-1 S t.
  VectorXd t = z;
  for (int i = 0; i < kPowerSeriesTerms; ++i) {
    multiply(t, image_);
    applyDiagonal(image_, term_);
    t -= term_;
    z += t;
  }
}

VectorXd ReducedOperator::reducedOf(const VectorXd& full, const std::vector<int>& offset) const {
  VectorXd result(size());
  for (int c = 0; c < left(); ++c) {
    result.segment(start_[at(c)], dof(c)) = full.segment(offset[at(eliminated_.count() + c)], dof(c));
  }
  return result;
}

void ReducedOperator::putInto(const VectorXd& reduced, const std::vector<int>& offset, VectorXd& full) const {
  for (int c = 0; c < left(); ++c) {
    full.segment(offset[at(eliminated_.count() + c)], dof(c)) = reduced.segment(start_[at(c)], dof(c));
  }
}

ConjugateGradientsOutcome conjugateGradients(ReducedOperator& S, const VectorXd& b, double tolerance,
                                             int max_iterations, VectorXd& x) {
  ConjugateGradientsOutcome outcome;
  x = VectorXd::Zero(b.size());
  VectorXd r = b, z, image;
  S.precondition(r, z);
  VectorXd p = z;
  double rz = r.dot(z);
  const double enough = tolerance * tolerance * rz;
  while (rz > enough && outcome.iterations < max_iterations) {
    S.multiply(p, image);
    const double curvature = p.dot(image);
    if (!(curvature > 0)) {
      outcome.ok = outcome.iterations > 0;  // the solution so far still leads downhill
      outcome.has_converged = false;
      return outcome;
    }
    ++outcome.iterations;
    const double alpha = rz / curvature;
    x += alpha * p;
    r -= alpha * image;
    S.precondition(r, z);
    const double rz_next = r.dot(z);
    p = z + (rz_next / rz) * p;
    rz = rz_next;
  }
  outcome.has_converged = rz <= enough;
  return outcome;
}

}  // namespace slom
