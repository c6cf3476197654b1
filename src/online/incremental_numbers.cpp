/// Factorisation of fronts, and gradients passed up the tree.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "online/incremental_cholesky.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

namespace {

using dense::kStripe;
using dense::paddedToStripes;

/// Fraction of the diagonal entry of H below which a pivot may be rounding error, because errors of thousands of others
/// add up in it.
constexpr double kDoubtfulPivot = 1e-10;
/// Growth of the work per block since the last ordering at which all blocks are reordered.
constexpr double kMostGrowthOfWork = 2;
constexpr double kLittleWork = 1e5;

/// Adds to[kStripe j] += a^T b_j for consecutive columns b_j of Rows numbers, or of `rows` if Rows is 0.
template <int Rows>
void addProducts(int rows, const double* a, const double* b, int columns, double* to) {
  const int n = Rows > 0 ? Rows : rows;
  for (int j = 0; j < columns; ++j, b += n) {
    double sum = 0;
    for (int r = 0; r < n; ++r) sum += a[r] * b[r];
    to[kStripe * j] += sum;
  }
}
void addProducts(int rows, const double* a, const double* b, int columns, double* to) {
  switch (rows) {
    case 2:
      return addProducts<2>(rows, a, b, columns, to);
    case 3:
      return addProducts<3>(rows, a, b, columns, to);
    case 6:
      return addProducts<6>(rows, a, b, columns, to);
    default:
      return addProducts<0>(rows, a, b, columns, to);
  }
}

}  // namespace

void IncrementalCholesky::refactor() {
  rebuildTop();
  const double growth = static_cast<double>(filled_blocks_) /
                        static_cast<double>(std::max<std::size_t>(1, blocks_when_ordered_));
  if (factor_flops_ > kLittleWork + kMostGrowthOfWork * growth * flops_when_ordered_) reorder();
  while (!dirty_.empty()) {
    std::pop_heap(dirty_.begin(), dirty_.end(), std::greater<>());
    const auto [order, f] = dirty_.back();
    dirty_.pop_back();
    const Front& front = fronts_[at(f)];
    if (front.order != order || front.has_solution) continue;
    if (!front.has_factor) factorizeFront(f);
    solveFront(f);
  }
}

void IncrementalCholesky::recompute() {
  rebuildTop();
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    if (front.pivots.empty()) continue;
    front.has_factor = front.has_solution = false;
    pushDirty(static_cast<int>(f));
  }
  refactor();
}

/// Adds each number of a child's rows to the row's place in the parent.
void IncrementalCholesky::addRows(const Front& child, const std::vector<double>& from,
                                  std::vector<double>& to) {
  for (const dense::Run& piece : child.in_parent.pieces) {
    for (int i = 0; i < piece.length; ++i) to[at(piece.target + i)] += from[at(piece.row + i)];
  }
}

/// Returns the start of a row of the lower triangle, in the columns of the pivots or in the others. Entries of the row
/// are kStripe apart.
double* IncrementalCholesky::rowOf(Front& front, int row, bool to_panel) const {
  const auto inPanel = [&](double* panel, int i) {
    return panel + static_cast<std::ptrdiff_t>(kStripe) * front.p * (i / kStripe) + i % kStripe;
  };
  if (row < front.p) return inPanel(front.D.data(), row);
  const int i = row - front.p;
  if (to_panel) return inPanel(front.B.data(), i);
  return front.U.data() + dense::updateOffset(i / kStripe) + i % kStripe -
         static_cast<std::ptrdiff_t>(kStripe) * front.p;
}

double* IncrementalCholesky::entry(Front& front, int row, int column) const {
  return rowOf(front, row, column < front.p) + static_cast<std::ptrdiff_t>(kStripe) * column;
}

/// Adds the products of elements to the columns of the pivots, or to the others.
void IncrementalCholesky::addElements(Front& front, bool to_panel) {
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    const int rows = element.rows;
    const double* const A_e = A(e).data();
    const double* A_k = A_e;
    for (const auto& [at_k, dof_k] : element.places) {
      const double* A_l = A_e;
      for (const auto& [at_l, dof_l] : element.places) {
        const double* const first = A_l;
        A_l += static_cast<std::ptrdiff_t>(rows) * dof_l;
        if (at_l > at_k || (at_l < front.p) != to_panel) continue;
        for (int i = 0; i < dof_k; ++i) {
          double* const to = rowOf(front, at_k + i, to_panel) + static_cast<std::ptrdiff_t>(kStripe) * at_l;
          const double* const a = A_k + static_cast<std::ptrdiff_t>(rows) * i;
          addProducts(rows, a, first, at_l == at_k ? i + 1 : dof_l, to);
        }
      }
      A_k += static_cast<std::ptrdiff_t>(rows) * dof_k;
    }
  }
}

/// Adds the update matrices of the children to the columns of the pivots, or to the others.
void IncrementalCholesky::addChildren(Front& front, bool to_panel) {
  const auto& kernel = dense::kernels();
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    const dense::ShuffledChild update = child.in_parent.child(child.U.data());
    if (child.in_parent.is_sorted && to_panel) {
      kernel.addToPanel(update, front.D.data(), front.B.data(), front.p);
    } else if (child.in_parent.is_sorted) {
      kernel.addToUpdate(update, front.U.data(), front.p);
    } else if (to_panel) {
      kernel.addShuffledToPanel(update, front.D.data(), front.B.data(), front.p);
    } else {
      kernel.addShuffledToUpdate(update, front.U.data(), front.p);
    }
  }
}

void IncrementalCholesky::assemblePanel(Front& front, const std::vector<double>& corrections) {
  std::fill_n(front.D.data(), dense::panelSize(front.p, front.p), 0.0);
  std::fill_n(front.B.data(), dense::panelSize(front.u, front.p), 0.0);
  addElements(front, true);
  addChildren(front, true);
  for (int i = 0; i < front.p; ++i) *entry(front, i, i) += corrections[at(i)];
  for (int i = 0; i < static_cast<int>(front.undetermined.size()); ++i) {
    if (front.undetermined[at(i)] == 0) continue;
    for (int j = 0; j <= i; ++j) *entry(front, i, j) = 0;
    for (int k = i; k < front.p + front.u; ++k) *entry(front, k, i) = 0;
    *entry(front, i, i) = 1;
  }
}

void IncrementalCholesky::factorizeFront(int f) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  // This is the diagonal of H, from elements here and below.
  std::vector<double> diagonal(at(front.p + front.u), 0.0);
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    const double* a = A(e).data();
    for (const auto& [place, dof] : element.places) {
      for (int i = place; i < place + dof; ++i) {
        for (int r = 0; r < element.rows; ++r, ++a) diagonal[at(i)] += *a * *a;
      }
    }
  }
  for (const int c : front.children) addRows(fronts_[at(c)], fronts_[at(c)].diagonal_below, diagonal);
  if (!front.undetermined.empty())
    std::for_each(front.pivots.begin(), front.pivots.end(), [&](int b) { forgetUndetermined(b); });
  front.undetermined.clear();
  std::vector<double> least(at(front.p));
  for (int i = 0; i < front.p; ++i)
    least[at(i)] = std::max(kDoubtfulPivot * diagonal[at(i)], std::numeric_limits<double>::min());
  front.inverse.resize(at(paddedToStripes(front.p)));
  std::vector<double> corrections(at(front.p), 0.0);
  for (;;) {
    assemblePanel(front, corrections);
    double pivot = 0;
    const int done = kernel.factorize(front.D.data(), front.p, least.data(), front.inverse.data(), &pivot);
    if (done == front.p) break;
    corrections[at(done)] = correctionOf(front, done, pivot, diagonal[at(done)]);
    least[at(done)] = 0;
  }
  const int stripes = dense::stripesOf(front.u);
  if (stripes > 0) {
    kernel.solveStripes(front.D.data(), front.inverse.data(), front.p, front.B.data(), front.u, 0, stripes);
    kernel.updateStripes(front.B.data(), front.p, front.u, front.U.data(), 0, stripes);
    addElements(front, false);
    addChildren(front, false);
  }
  front.diagonal_below.assign(diagonal.begin() + front.p, diagonal.end());
  front.has_factor = true;
  front.factorization = ++factorizations_;
  ++work_.fronts_factorized;
  work_.flops += frontFlops(front.p, front.u);
}

/// Computes y := L^-1 g of the pivots. Their contributions to the rows go to the parent.
void IncrementalCholesky::solveFront(int f) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  std::vector<double> g(at(front.p + front.u), 0.0);
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    const double* from = gradient(e).data();
    for (const auto& [place, dof] : element.places) {
      for (int i = place; i < place + dof; ++i) g[at(i)] += *from++;
    }
  }
  front.promise_below = 0;
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    addRows(child, child.below, g);
    front.promise_below += child.own_promise + child.promise_below;
  }
  front.y.assign(at(paddedToStripes(front.p)), 0.0);
  std::copy_n(g.begin(), front.p, front.y.begin());
  for (std::size_t i = 0; i < front.undetermined.size(); ++i) {
    if (front.undetermined[i] != 0) front.y[i] = 0;
  }
  kernel.forwardPivots(front.D.data(), front.inverse.data(), front.p, front.y.data());
  rows_.assign(at(paddedToStripes(front.u)), 0.0);
  if (front.u > 0) kernel.forwardRows(front.B.data(), front.p, front.u, front.y.data(), rows_.data());
  front.below.resize(at(front.u));
  for (int i = 0; i < front.u; ++i) front.below[at(i)] = g[at(front.p + i)] + rows_[at(i)];
  front.own_promise = 0;
  for (int i = 0; i < front.p; ++i) front.own_promise += front.y[at(i)] * front.y[at(i)];
  front.has_solution = front.has_news = true;
  ++work_.fronts_solved;
  work_.flops += substitutionFlops(front.p, front.u);
}

double IncrementalCholesky::promise() const {
  double sum = 0;
  for (const int f : roots_) sum += fronts_[at(f)].own_promise + fronts_[at(f)].promise_below;
  return sum;
}

}  // namespace slom
