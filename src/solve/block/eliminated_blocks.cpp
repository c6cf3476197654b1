#include "eliminated_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/index.hpp"
#include "base/threads.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

namespace {

constexpr int kPerTask = 256;

/// Calls f with the size as a constant if it is that of points in space, which compilers optimise well; otherwise with
/// 0.
template <class F>
void withSize(int d, const F& f) {
  d == 3 ? f(std::integral_constant<int, 3>{}) : f(std::integral_constant<int, 0>{});
}

/// Computes L of V + damping (null: none). On success, the failure names no component.
template <int D>
EliminatedBlocks::Failure factorizeOne(int size, const double* V, const double* damping, double tolerance,
                                       double* L) {
  const int d = D > 0 ? D : size;
  for (int j = 0; j < d; ++j) {
    const double diagonal = V[j * d + j] + (damping != nullptr ? damping[j] : 0);
    double pivot = diagonal;
    for (int k = 0; k < j; ++k) pivot -= L[k * d + j] * L[k * d + j];
    if (!(pivot > tolerance * diagonal)) return {0, j, diagonal > 0 ? std::max(0.0, pivot / diagonal) : 0.0};
    const double inverse = 1 / std::sqrt(pivot);
    L[j * d + j] = inverse;
    for (int i = j + 1; i < d; ++i) {
      double sum = V[j * d + i];
      for (int k = 0; k < j; ++k) sum -= L[k * d + i] * L[k * d + j];
      L[j * d + i] = sum * inverse;
    }
  }
  return {};
}

template <int D>
void forwardOne(int size, const double* L, double* b) {
  const int d = D > 0 ? D : size;
  for (int i = 0; i < d; ++i) {
    for (int j = 0; j < i; ++j) b[i] -= L[j * d + i] * b[j];
    b[i] *= L[i * d + i];
  }
}

template <int D>
void backwardOne(int size, const double* L, double* b) {
  const int d = D > 0 ? D : size;
  for (int i = d - 1; i >= 0; --i) {
    for (int j = i + 1; j < d; ++j) b[i] -= L[i * d + j] * b[j];
    b[i] *= L[i * d + i];
  }
}

}  // namespace

void EliminatedBlocks::analyze(const BlockLower& H, int count) {
  count_ = count;
  start_.assign(1, 0);
  for (int e = 0; e < count; ++e) start_.push_back(start_.back() + at(H.dof(e)) * at(H.dof(e)));
  factors_.assign(start_.back(), 0.0);
}

EliminatedBlocks::Failure EliminatedBlocks::factorize(const BlockLower& H, int first, int last,
                                                      const std::vector<int>& offset,
                                                      const Eigen::VectorXd& damping, double tolerance) {
  for (int e = first; e < last; ++e) {
    Failure failure;
    withSize(H.dof(e), [&](auto n) {
      failure = factorizeOne<n>(H.dof(e), H.values(H.begin(e)),
                                damping.size() > 0 ? damping.data() + offset[at(e)] : nullptr, tolerance,
                                factors_.data() + start_[at(e)]);
    });
    if (failure.component < 0) continue;
    failure.e = e;
    return failure;
  }
  return {};
}

SolveStatus EliminatedBlocks::factorizeAll(const BlockLower& H, const std::vector<int>& offset,
                                           const Eigen::VectorXd& damping, double tolerance) {
  std::vector<Failure> failures(at((count_ + kPerTask - 1) / kPerTask));
  detail::forEachIndex(static_cast<int>(failures.size()), [&](int task) {
    failures[at(task)] =
        factorize(H, task * kPerTask, std::min(count_, (task + 1) * kPerTask), offset, damping, tolerance);
  });
  const auto bad =
      std::find_if(failures.begin(), failures.end(), [](const Failure& f) { return f.happened(); });
  return bad == failures.end() ? SolveStatus{} : status(*bad, offset);
}

SolveStatus EliminatedBlocks::status(const Failure& failure, const std::vector<int>& offset) {
  return {false, offset[at(failure.e)] + failure.component, failure.ratio};
}

void EliminatedBlocks::forward(int e, int d, double* b) const {
  withSize(d, [&](auto n) { forwardOne<n>(d, factor(e), b); });
}

void EliminatedBlocks::backward(int e, int d, double* b) const {
  withSize(d, [&](auto n) { backwardOne<n>(d, factor(e), b); });
}

void EliminatedBlocks::invert(const BlockLower& H, int e, const BlockLower& Z, BlockLower& inverse) const {
  using Eigen::MatrixXd;
  using Block = Eigen::Map<const MatrixXd>;
  const int d = H.dof(e), first = H.begin(e) + 1, last = H.begin(e + 1);
  const auto solve = [&](MatrixXd columns) {
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
      forward(e, d, columns.col(j).data());
      backward(e, d, columns.col(j).data());
    }
    return columns;
  };
  std::vector<MatrixXd> T;  // by neighbour: V^-1 W^T
  for (int k = first; k < last; ++k) T.push_back(solve(Block(H.values(k), H.dof(H.row(k)), d).transpose()));
  MatrixXd own = solve(MatrixXd::Identity(d, d));
  for (int k = first; k < last; ++k) {
    const int i = H.row(k) - count_;
    Eigen::Map<MatrixXd> below(inverse.values(k), H.dof(H.row(k)), d);
    below.setZero();
    for (int l = first; l < last; ++l) {
      const int j = H.row(l) - count_;
      const Block z(Z.values(Z.find(std::max(i, j), std::min(i, j))), Z.dof(std::max(i, j)),
                    Z.dof(std::min(i, j)));
      if (i >= j) {
        below.noalias() -= z * T[at(l - first)].transpose();
      } else {
        below.noalias() -= z.transpose() * T[at(l - first)].transpose();
      }
    }
    own.noalias() -= T[at(k - first)] * below;
  }
  Eigen::Map<MatrixXd>(inverse.values(H.begin(e)), d, d) = (own + own.transpose()) / 2;
}

void EliminatedBlocks::reduceVector(const BlockLower& H, const std::vector<int>& offset,
                                    Eigen::VectorXd& b) const {
  const auto subtract_product = dense::kernels().subtractProduct;
  std::vector<double> solved;
  for (int e = 0; e < count_; ++e) {
    const int d = H.dof(e);
    solved.assign(b.data() + offset[at(e)], b.data() + offset[at(e)] + d);
    forward(e, d, solved.data());
    backward(e, d, solved.data());
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
      subtract_product(d, H.dof(H.row(k)), H.values(k), solved.data(), b.data() + offset[at(H.row(k))]);
    }
  }
}

void EliminatedBlocks::substitute(const BlockLower& H, const std::vector<int>& offset,
                                  Eigen::VectorXd& x) const {
  const auto subtract_product = dense::kernels().subtractTransposedProduct;
  detail::forEachIndex((count_ + kPerTask - 1) / kPerTask, [&](int task) {
    for (int e = task * kPerTask; e < std::min(count_, (task + 1) * kPerTask); ++e) {
      const int d = H.dof(e);
      double* const own = x.data() + offset[at(e)];
      for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
        subtract_product(d, H.dof(H.row(k)), H.values(k), x.data() + offset[at(H.row(k))], own);
      }
      forward(e, d, own);
      backward(e, d, own);
    }
  });
}

}  // namespace slom
