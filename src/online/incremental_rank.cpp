/// Undetermined unknowns: pivots that are rounding error.
#include <algorithm>
#include <utility>

#include "online/incremental_cholesky.hpp"

namespace slom {

namespace {

/// Fraction of the column of A^T A below which the remaining part leaves the unknown undetermined: it stays where it
/// is.
constexpr double kLeastOnlinePivot = 1e-13;

}  // namespace

void IncrementalCholesky::forgetUndetermined(int block) {
  undetermined_.erase(undetermined_.lower_bound({block, 0}), undetermined_.lower_bound({block + 1, 0}));
}

/// Returns the correction of the diagonal that makes a doubtful pivot right. Holds the pivot if it is undetermined.
///
/// In exact arithmetic the pivot of unknown k is |A w|^2, with w_k = 1, w = 0 after k, and the entries before k chosen
/// such that |A w| is least. The difference computed by the factorisation has the rounding errors of all terms w_i^2
/// H_ii. |A w|^2 has almost none.
double IncrementalCholesky::correctionOf(Front& front, int pivot, double computed, double diagonal) {
  const double exact = squaredLengthAlong(front, pivot);
  if (exact > kLeastOnlinePivot * diagonal) return exact - computed;
  hold(front, pivot);
  return 0;
}

/// Returns |A w|^2 of a pivot of the front, which is factorised up to that pivot.
double IncrementalCholesky::squaredLengthAlong(Front& front, int pivot) {
  const auto& kernel = dense::kernels();
  std::vector<double> w(at(front.p + front.u), 0.0);
  w[at(pivot)] = 1;
  for (int i = pivot - 1; i >= 0; --i) {
    for (int k = i + 1; k <= pivot; ++k) w[at(i)] -= *entry(front, k, i) * w[at(k)];
    w[at(i)] /= *entry(front, i, i);
  }
  double sum = 0;
  std::vector<std::pair<const Front*, std::vector<double>>> to_visit;
  to_visit.emplace_back(&front, std::move(w));
  while (!to_visit.empty()) {
    const auto [own, x] = std::move(to_visit.back());
    to_visit.pop_back();
    for (const int e : own->elements) sum += squaredLengthOf(elements_[at(e)], x);
    for (const int c : own->children) {
      const Front& child = fronts_[at(c)];
      rows_.assign(at(dense::paddedToStripes(child.u)), 0.0);
      for (int i = 0; i < child.u; ++i) rows_[at(i)] = x[at(child.in_parent.columns[at(i)] / dense::kStripe)];
      if (std::all_of(rows_.begin(), rows_.end(), [](double r) { return r == 0; })) continue;
      std::vector<double> d(at(dense::paddedToStripes(child.p)), 0.0);
      kernel.backwardRows(child.B.data(), child.p, child.u, rows_.data(), d.data());
      kernel.backwardPivots(child.D.data(), child.inverse.data(), child.p, d.data());
      work_.flops += substitutionFlops(child.p, child.u);
      d.resize(at(child.p));
      d.insert(d.end(), rows_.begin(), rows_.begin() + child.u);
      to_visit.emplace_back(&child, std::move(d));
    }
  }
  return sum;
}

/// Returns |A_e x|^2 for x of the element's front.
double IncrementalCholesky::squaredLengthOf(const Element& element, const std::vector<double>& x) const {
  double sum = 0;
  for (int r = 0; r < element.rows; ++r) {
    const double* a = numbers_.data() + element.start + r;
    double row = 0;
    for (const auto& [place, dof] : element.places) {
      for (int i = place; i < place + dof; ++i, a += element.rows) row += *a * x[at(i)];
    }
    sum += row * row;
  }
  return sum;
}

/// Marks the pivot as undetermined: its unknown stays where it is.
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

}  // namespace slom
