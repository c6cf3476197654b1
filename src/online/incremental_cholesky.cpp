#include "online/incremental_cholesky.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "solve/dense/kernels.hpp"

namespace slom {

// ---- blocks and elements ---------------------------------------------------------------------------------------

void IncrementalCholesky::insertBlock(int block, int dof) {
  if (block >= blockCount()) {
    blocks_.resize(at(block + 1));
    local_.resize(at(block + 1), -1);
  }
  blocks_[at(block)] = {dof, -1, 0, next_age_++};
  ++filled_blocks_;
  loose_blocks_.push_back(block);
}

void IncrementalCholesky::removeBlock(int block) {
  markPathFrom(block);
  std::erase(loose_blocks_, block);
  forgetUndetermined(block);
  blocks_[at(block)] = {};
  --filled_blocks_;
}

int IncrementalCholesky::insertElement(std::span<const int> blocks, int rows) {
  int e = static_cast<int>(elements_.size());
  if (free_elements_.empty()) {
    elements_.emplace_back();
  } else {
    e = free_elements_.back();
    free_elements_.pop_back();
  }
  Element& element = elements_[at(e)];
  element.blocks.assign(blocks.begin(), blocks.end());
  element.rows = rows;
  element.columns = 0;
  element.front = -1;
  for (const int b : blocks) {
    element.columns += dof(b);
    markPathFrom(b);
  }
  element.squared_norm = 0;
  element.start = roomFor(element.entries() + at(element.columns));
  loose_elements_.push_back(e);
  return e;
}

/// Returns a place in numbers_ for that many zeros.
std::size_t IncrementalCholesky::roomFor(std::size_t count) {
  std::vector<std::size_t>& free = free_numbers_[count];
  if (free.empty()) {
    numbers_.resize(numbers_.size() + count, 0.0);
    return numbers_.size() - count;
  }
  const std::size_t start = free.back();
  free.pop_back();
  std::fill_n(numbers_.begin() + static_cast<std::ptrdiff_t>(start), count, 0.0);
  return start;
}

void IncrementalCholesky::removeElement(int e) {
  Element& element = elements_[at(e)];
  free_numbers_[element.entries() + at(element.columns)].push_back(element.start);
  for (const int b : element.blocks) markPathFrom(b);
  std::erase(loose_elements_, e);
  element = {};
  free_elements_.push_back(e);
}

void IncrementalCholesky::setA(int e, std::span<const double> A) {
  Element& element = elements_[at(e)];
  std::copy(A.begin(), A.end(), numbers_.begin() + static_cast<std::ptrdiff_t>(element.start));
  element.squared_norm =
      Eigen::Map<const Eigen::VectorXd>(A.data(), static_cast<Eigen::Index>(A.size())).squaredNorm();
  if (element.front >= 0) touch(element.front, true);
}

void IncrementalCholesky::setGradient(int e, std::span<const double> g) {
  Element& element = elements_[at(e)];
  std::copy(g.begin(), g.end(),
            numbers_.begin() + static_cast<std::ptrdiff_t>(element.start + element.entries()));
  if (element.front >= 0) touch(element.front, false);
}

/// Marks the front and those above it for recomputation.
void IncrementalCholesky::touch(int f, bool is_factor) {
  for (; f >= 0; f = fronts_[at(f)].parent) {
    Front& front = fronts_[at(f)];
    const bool is_known = !front.has_solution && (!front.has_factor || !is_factor);
    if (is_factor) front.has_factor = false;
    front.has_solution = false;
    if (is_known) return;  // the fronts above are marked too
    pushDirty(f);
  }
}

void IncrementalCholesky::pushDirty(int f) {
  dirty_.emplace_back(fronts_[at(f)].order, f);
  std::push_heap(dirty_.begin(), dirty_.end(), std::greater<>());
}

// ---- steps --------------------------------------------------------------------------------------------------

const std::vector<IncrementalCholesky::Move>& IncrementalCholesky::solve(double threshold, bool everywhere) {
  moves_.clear();
  step_.clear();
  to_visit_.clear();
  for (const int f : roots_) {
    const Front& front = fronts_[at(f)];
    if (front.own_promise + front.promise_below > threshold) to_visit_.push_back(f);
  }
  while (!to_visit_.empty()) {
    const int f = to_visit_.back();
    to_visit_.pop_back();
    goDown(f, threshold, everywhere);
  }
  for (Move& move : moves_) move.d = step_.data() + std::exchange(local_[at(move.block)], -1);
  return moves_;
}

/// Computes d of the front's pivots from d of its rows, unless its predicted decrease is negligible. Continues with
/// children whose rows have moved or whose subtrees have some decrease left.
void IncrementalCholesky::goDown(int f, double threshold, bool everywhere) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  std::vector<double> d(at(dense::paddedToStripes(front.p)), 0.0);
  for (int i = 0; i < front.p; ++i) d[at(i)] = -front.y[at(i)];
  if (front.u > 0) {
    rows_.assign(at(dense::paddedToStripes(front.u)), 0.0);
    int i = 0;
    for (const int b : front.rows) {
      const int place = local_[at(b)];  // place in the step, if the block moved
      if (place >= 0) std::copy_n(step_.data() + place, dof(b), rows_.data() + i);
      i += dof(b);
    }
    kernel.backwardRows(front.B.data(), front.p, front.u, rows_.data(), d.data());
  }
  work_.flops += substitutionFlops(front.p, front.u);
  double promised = 0;
  for (int i = 0; i < front.p; ++i) promised += d[at(i)] * d[at(i)];
  if (promised > threshold) {
    kernel.backwardPivots(front.D.data(), front.inverse.data(), front.p, d.data());
    int i = 0;
    for (const int b : front.pivots) {
      local_[at(b)] = static_cast<int>(step_.size());
      moves_.push_back({b, nullptr});
      for (int c = 0; c < dof(b); ++c, ++i) {
        const bool is_undetermined = !front.undetermined.empty() && front.undetermined[at(i)] != 0;
        step_.push_back(is_undetermined ? 0 : d[at(i)]);
      }
    }
  }
  front.has_news = false;
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    const bool has_more =
        (everywhere || child.has_news) && child.own_promise + child.promise_below > threshold;
    if (has_more ||
        std::any_of(child.rows.begin(), child.rows.end(), [&](int b) { return local_[at(b)] >= 0; }))
      to_visit_.push_back(c);
  }
}

std::vector<double> IncrementalCholesky::content() const {
  std::set<std::pair<std::uint64_t, int>> all;
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    if (!fronts_[f].pivots.empty()) all.emplace(fronts_[f].order, static_cast<int>(f));
  }
  std::vector<double> numbers;
  for (const auto& [order, f] : all) {
    const Front& front = fronts_[at(f)];
    numbers.insert(numbers.end(), front.D.data(), front.D.data() + dense::panelSize(front.p, front.p));
    numbers.insert(numbers.end(), front.B.data(), front.B.data() + dense::panelSize(front.u, front.p));
    numbers.insert(numbers.end(), front.y.begin(), front.y.end());
    numbers.insert(numbers.end(), front.below.begin(), front.below.end());
  }
  return numbers;
}

}  // namespace slom
