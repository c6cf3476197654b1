/// Factorisation of fronts, and gradients on their way up.
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

/// A pivot below this share of the diagonal entry of H is rounding error.
constexpr double kLeastOnlinePivot = 1e-13;
/// All blocks are reordered when the work per block has grown by this factor since the last ordering.
constexpr double kMostGrowth = 2;
constexpr double kLittleWork = 1e5;

}  // namespace

void IncrementalCholesky::refactor() {
  rebuildTop();
  const double growth = static_cast<double>(filled_blocks_) /
                        static_cast<double>(std::max<std::size_t>(1, blocks_when_ordered_));
  if (factor_flops_ > kLittleWork + kMostGrowth * growth * flops_when_ordered_) reorder();
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

/// Says where each block of the front begins in it.
void IncrementalCholesky::place(const Front& front) {
  int offset = 0;
  for (const std::vector<int>* blocks : {&front.pivots, &front.rows}) {
    for (const int b : *blocks) {
      local_[at(b)] = offset;
      offset += blocks_[at(b)].dof;
    }
  }
}

void IncrementalCholesky::forgetPlaces(const Front& front) {
  for (const std::vector<int>* blocks : {&front.pivots, &front.rows}) {
    for (const int b : *blocks) local_[at(b)] = -1;
  }
}

/// Adds entries of blocks, one after the other, where these are placed.
void IncrementalCholesky::addByPlace(const std::vector<int>& blocks, const double* from,
                                     std::vector<double>& to) const {
  for (const int b : blocks) {
    for (int i = 0; i < dof(b); ++i) to[at(local_[at(b)] + i)] += *from++;
  }
}

void IncrementalCholesky::forgetUndetermined(int block) {
  undetermined_.erase(undetermined_.lower_bound({block, 0}), undetermined_.lower_bound({block + 1, 0}));
}

/// Where a row of the lower triangle begins, in the columns of the pivots or in the others: its entries are kStripe apart.
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
    const double* A_k = A(e).data();
    for (const int k : element.blocks) {
      const int dof_k = dof(k), at_k = local_[at(k)];
      const double* A_l = A(e).data();
      for (const int l : element.blocks) {
        const int dof_l = dof(l), at_l = local_[at(l)];
        const double* const first = A_l;
        A_l += static_cast<std::ptrdiff_t>(rows) * dof_l;
        if (at_l > at_k || (at_l < front.p) != to_panel) continue;
        for (int i = 0; i < dof_k; ++i) {
          double* const to = rowOf(front, at_k + i, to_panel) + static_cast<std::ptrdiff_t>(kStripe) * at_l;
          const double* const a = A_k + static_cast<std::ptrdiff_t>(rows) * i;
          const int columns = at_l == at_k ? i + 1 : dof_l;
          for (int j = 0; j < columns; ++j) {
            const double* const b = first + static_cast<std::ptrdiff_t>(rows) * j;
            double sum = 0;
            for (int r = 0; r < rows; ++r) sum += a[r] * b[r];
            to[kStripe * j] += sum;
          }
        }
      }
      A_k += static_cast<std::ptrdiff_t>(rows) * dof_k;
    }
  }
}

/// Adds the update matrices of the children, block by block: in the order of the front's rows, which may not be that of the child's.
void IncrementalCholesky::addChildren(Front& front, bool to_panel) {
  struct Part {
    int to, from, dof;
  };
  std::vector<Part> parts;
  for (const int c : front.children) {
    Front& child = fronts_[at(c)];
    parts.clear();
    int from = 0;
    for (const int b : child.rows) {
      parts.push_back({local_[at(b)], from, dof(b)});
      from += dof(b);
    }
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.to < b.to; });
    const double* const U = child.U.data();
    const auto rowOfU = [&](int i) { return U + dense::updateOffset(i / kStripe) + i % kStripe; };
    for (std::size_t a = 0; a < parts.size(); ++a) {
      const Part& row = parts[a];
      // Rows that lie side by side, here and there.
      for (int i = 0, count = 0; i < row.dof; i += count) {
        const int to_row = row.to + i < front.p ? row.to + i : row.to + i - front.p;
        count = std::min({row.dof - i, kStripe - (row.from + i) % kStripe, kStripe - to_row % kStripe});
        double* const to = rowOf(front, row.to + i, to_panel);
        const double* const own = rowOfU(row.from + i);
        for (std::size_t b = 0; b <= a; ++b) {
          const Part& column = parts[b];
          if ((column.to < front.p) != to_panel) continue;
          double* const into = to + static_cast<std::ptrdiff_t>(kStripe) * column.to;
          if (a == b) {
            const double* const u = own + static_cast<std::ptrdiff_t>(kStripe) * column.from;
            for (int k = 0; k < count; ++k) {
              for (int j = 0; j <= i + k; ++j) into[kStripe * j + k] += u[kStripe * j + k];
            }
          } else if (column.from < row.from) {
            const double* const u = own + static_cast<std::ptrdiff_t>(kStripe) * column.from;
            for (int j = 0; j < column.dof; ++j) {
              for (int k = 0; k < count; ++k) into[kStripe * j + k] += u[kStripe * j + k];
            }
          } else {
            for (int j = 0; j < column.dof; ++j) {
              const double* const u =
                  rowOfU(column.from + j) + static_cast<std::ptrdiff_t>(kStripe) * (row.from + i);
              for (int k = 0; k < count; ++k) into[kStripe * j + k] += u[kStripe * k];
            }
          }
        }
      }
    }
  }
}

void IncrementalCholesky::assemblePanel(Front& front) {
  std::fill_n(front.D.data(), dense::panelSize(front.p, front.p), 0.0);
  std::fill_n(front.B.data(), dense::panelSize(front.u, front.p), 0.0);
  addElements(front, true);
  addChildren(front, true);
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
  place(front);
  // The diagonal of H: of elements here and below.
  std::vector<double> diagonal(at(front.p + front.u), 0.0);
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    const double* a = A(e).data();
    for (const int b : element.blocks) {
      for (int i = 0; i < dof(b); ++i) {
        for (int r = 0; r < element.rows; ++r, ++a) diagonal[at(local_[at(b)] + i)] += *a * *a;
      }
    }
  }
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    addByPlace(child.rows, child.diagonal_below.data(), diagonal);
  }
  if (!front.undetermined.empty())
    std::for_each(front.pivots.begin(), front.pivots.end(), [&](int b) { forgetUndetermined(b); });
  front.undetermined.clear();
  std::vector<double> least(at(front.p));
  for (int i = 0; i < front.p; ++i)
    least[at(i)] = std::max(kLeastOnlinePivot * diagonal[at(i)], std::numeric_limits<double>::min());
  front.inverse.resize(at(paddedToStripes(front.p)));
  for (;;) {
    assemblePanel(front);
    double pivot = 0;
    const int done = kernel.factorize(front.D.data(), front.p, least.data(), front.inverse.data(), &pivot);
    if (done == front.p) break;
    hold(front, done);
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
  forgetPlaces(front);
}

/// Nothing determines the pivot: it stays where it is.
void IncrementalCholesky::hold(Front& front, int pivot) {
  front.undetermined.resize(at(front.p), 0);
  front.undetermined[at(pivot)] = 1;
  int offset = 0;
  for (const int b : front.pivots) {
    if (pivot < offset + dof(b)) {
      undetermined_.emplace(b, pivot - offset);
      return;
    }
    offset += dof(b);
  }
}

/// y := L^-1 g of the pivots; what they take from the rows goes to the parent.
void IncrementalCholesky::solveFront(int f) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  place(front);
  std::vector<double> g(at(front.p + front.u), 0.0);
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    addByPlace(element.blocks, gradient(e).data(), g);
  }
  front.promise_below = 0;
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    addByPlace(child.rows, child.below.data(), g);
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
  forgetPlaces(front);
}

double IncrementalCholesky::promise() const {
  double sum = 0;
  for (const int f : roots_) sum += fronts_[at(f)].own_promise + fronts_[at(f)].promise_below;
  return sum;
}

}  // namespace slom
