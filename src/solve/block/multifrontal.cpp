#include "multifrontal.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/threads.hpp"

namespace slom {

namespace {

using dense::kernels;
using dense::kStripe;
using dense::stripesOf;

}  // namespace

/// Assembles the front's columns of H + damping.
void MultifrontalCholesky::assemble(const BlockLower& H, const Front& front, const Layout& layout) {
  double* const D = L_.data() + layout.D;
  double* const B = L_.data() + layout.B;
  for (int end = kStripe; end - kStripe < front.p; end += kStripe) {
    std::fill_n(D + kStripe * front.p * (end / kStripe - 1), kStripe * std::min(end, front.p), 0.0);
  }
  std::fill_n(B, dense::panelSize(front.u, front.p), 0.0);
  const auto address = [&](int row) {
    const auto in_panel = [&](double* panel, int i) {
      return panel + static_cast<std::ptrdiff_t>(kStripe) * front.p * (i / kStripe) + i % kStripe;
    };
    return row < front.p ? in_panel(D, row) : in_panel(B, row - front.p);
  };
  for (int e = layout.first_entry; e < layout.last_entry; ++e) {
    const Entry& entry = entries_[at(e)];
    const double* const from = H.values(entry.block);
    for (int i = 0; i < entry.height;) {
      const int row = entry.row + i;
      const int in_stripe = (row < front.p ? row : row - front.p) % kStripe;
      const int length = std::min(kStripe - in_stripe, entry.height - i);
      double* const to = address(row) + kStripe * entry.column;
      for (int c = 0; c < entry.width; ++c) {
        for (int k = 0; k < length; ++k) to[kStripe * c + k] = from[c * entry.height + i + k];
      }
      i += length;
    }
  }
  const int first = fronts_.offset[at(front.first_column)];
  for (int i = 0; i < front.p; ++i) address(i)[kStripe * i] += shift_[at(first + i)];
}

MultifrontalCholesky::Failure MultifrontalCholesky::factorizeFront(const BlockLower& H, int f,
                                                                   bool in_parallel) {
  const auto& kernel = kernels();
  const Front& front = fronts_.front[at(f)];
  const Layout& layout = layout_[at(f)];
  double* const D = L_.data() + layout.D;
  double* const B = L_.data() + layout.B;
  double* const U = updates_.data() + layout.U;
  assemble(H, front, layout);
  const auto add_children = [&](auto add) {
    for (int c = layout.first_child; c < layout.last_child; ++c) {
      const Layout& child = layout_[at(children_[at(c)])];
      const dense::Child update{runs_.data() + child.first_run, child.last_run - child.first_run,
                                relative_.data() + child.relative, fronts_.front[at(children_[at(c)])].u,
                                updates_.data() + child.U};
      add(update);
    }
  };
  add_children([&](const dense::Child& child) { kernel.addToPanel(child, D, B, front.p); });

  const int first = fronts_.offset[at(front.first_column)];
  Failure failure;
  double* const inverse = inverse_.data() + first;
  const int done = kernel.factorize(D, front.p, least_.data() + first, inverse, &failure.value);
  if (done < front.p) {
    failure.pivot = first + done;
    return failure;
  }
  const int stripes = stripesOf(front.u);
  const auto each_stripe = [&](int s) { kernel.solveStripes(D, inverse, front.p, B, front.u, s, s + 1); };
  const auto each_update = [&](int s) { kernel.updateStripes(B, front.p, front.u, U, s, s + 1); };
  if (in_parallel && work(front) > kSmallestTask) {
    detail::forEachIndex(stripes, each_stripe);
    detail::forEachIndex(stripes, [&](int s) { each_update(stripes - 1 - s); });
  } else {
    for (int s = 0; s < stripes; ++s) each_stripe(s);
    for (int s = 0; s < stripes; ++s) each_update(s);
  }
  add_children([&](const dense::Child& child) { kernel.addToUpdate(child, U, front.p); });
  if (solves_forward_) forward(f, own_);
  return failure;
}

MultifrontalCholesky::Failure MultifrontalCholesky::factorizeSubtree(const BlockLower& H, int subtree) {
  const bool is_top = subtree + 1 == static_cast<int>(subtree_.size());
  for (const int f : subtree_[at(subtree)]) {
    const Failure failure = factorizeFront(H, f, is_top);
    if (failure.pivot >= 0) return failure;
  }
  return {};
}

/// Factorises all fronts in order. A failure in a subtree takes precedence over one above the subtrees, so that threads
/// give the same result.
MultifrontalCholesky::Failure MultifrontalCholesky::factorizeSequentially(const BlockLower& H) {
  Failure above;
  for (int f = 0; f < static_cast<int>(layout_.size()); ++f) {
    const bool is_above = subtree_of_[at(f)] + 1 == static_cast<int>(subtree_.size());
    if (is_above && above.pivot >= 0) continue;
    const Failure failure = factorizeFront(H, f, false);
    if (failure.pivot < 0) continue;
    if (!is_above) return failure;
    above = failure;
  }
  return above;
}

/// Calls f for each subtree except the one above the others.
template <class F>
void MultifrontalCholesky::forEachSubtree(const F& f) const {
  detail::forEachIndex(static_cast<int>(subtree_.size()) - 1, f);
}

MultifrontalCholesky::Failure MultifrontalCholesky::factorizeSubtrees(const BlockLower& H) {
  std::vector<Failure> failures(subtree_.size());
  forEachSubtree([&](int t) { failures[at(t)] = factorizeSubtree(H, t); });
  const auto earlier = [](const Failure& a, const Failure& b) {
    return a.pivot >= 0 && (b.pivot < 0 || a.pivot < b.pivot);
  };
  const Failure first = *std::min_element(failures.begin(), failures.end(), earlier);
  return first.pivot >= 0 ? first : factorizeSubtree(H, static_cast<int>(subtree_.size()) - 1);
}

SolveStatus MultifrontalCholesky::factorize(const BlockLower& H, const Eigen::VectorXd& diagonal,
                                            const Eigen::VectorXd& damping, double tolerance,
                                            const Eigen::VectorXd* b) {
  solves_forward_ = b != nullptr;
  if (solves_forward_) begin(*b, own_);
  for (std::size_t i = 0; i < least_.size(); ++i) {
    const int unknown = unknown_[i];
    shift_[i] = damping.size() > 0 ? damping[unknown] : 0;
    least_[i] = tolerance * (diagonal[unknown] + shift_[i]);
  }
  if (is_sequential_ && detail::threadCount() > 1) planUpdates(false);
  const Failure first = is_sequential_ ? factorizeSequentially(H) : factorizeSubtrees(H);
  if (first.pivot < 0) return {};
  const double reference = least_[at(first.pivot)] / tolerance;
  return {false, unknown_[at(first.pivot)], reference > 0 ? std::max(0.0, first.value / reference) : 0.0};
}

/// Computes x := L^-1 x for the front's pivots. What this subtracts from later rows goes to the parent, through
/// `solution.rows`.
void MultifrontalCholesky::forward(int f, Workspace& solution) const {
  const auto& kernel = kernels();
  const Front& front = fronts_.front[at(f)];
  const Layout& layout = layout_[at(f)];
  double* const x = solution.x.data() + fronts_.offset[at(front.first_column)];
  double* const rows = solution.rows.data() + layout.vector;
  const auto add_children = [&](auto target_of) {
    for (int c = layout.first_child; c < layout.last_child; ++c) {
      const Layout& child = layout_[at(children_[at(c)])];
      const double* const from = solution.rows.data() + child.vector;
      for (int r = child.first_run; r < child.last_run; ++r) {
        const dense::Run& run = runs_[at(r)];
        double* const to = target_of(run.target);
        if (to == nullptr) continue;
        for (int i = 0; i < run.length; ++i) to[i] += from[run.row + i];
      }
    }
  };
  add_children([&](int target) { return target < front.p ? x + target : nullptr; });
  kernel.forwardPivots(L_.data() + layout.D, inverse_.data() + fronts_.offset[at(front.first_column)],
                       front.p, x);
  kernel.forwardRows(L_.data() + layout.B, front.p, front.u, x, rows);
  add_children([&](int target) { return target < front.p ? nullptr : rows + (target - front.p); });
}

void MultifrontalCholesky::backward(int f, Workspace& solution) const {
  const auto& kernel = kernels();
  const Front& front = fronts_.front[at(f)];
  const Layout& layout = layout_[at(f)];
  double* const x = solution.x.data() + fronts_.offset[at(front.first_column)];
  double* to = solution.rows.data() + layout.vector;
  for (int r = front.first_row; r < front.last_row; ++r) {
    const int position = fronts_.row[at(r)];
    for (int i = fronts_.offset[at(position)]; i < fronts_.offset[at(position) + 1]; ++i)
      *to++ = solution.x[at(i)];
  }
  kernel.backwardRows(L_.data() + layout.B, front.p, front.u, solution.rows.data() + layout.vector, x);
  kernel.backwardPivots(L_.data() + layout.D, inverse_.data() + fronts_.offset[at(front.first_column)],
                        front.p, x);
}

void MultifrontalCholesky::begin(const Eigen::VectorXd& b, Workspace& solution) const {
  for (std::size_t i = 0; i < solution.x.size(); ++i) solution.x[i] = b[unknown_[i]];
}

Eigen::VectorXd MultifrontalCholesky::end(const Workspace& solution) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(solution.x.size()));
  for (std::size_t i = 0; i < solution.x.size(); ++i) result[unknown_[i]] = solution.x[i];
  return result;
}

void MultifrontalCholesky::forwardSolve(const Eigen::VectorXd& b) {
  begin(b, own_);
  forEachSubtree([&](int t) {
    for (const int f : subtree_[at(t)]) forward(f, own_);
  });
  for (const int f : subtree_.back()) forward(f, own_);
}

Eigen::VectorXd MultifrontalCholesky::backSolve() {
  for (auto f = subtree_.back().rbegin(); f != subtree_.back().rend(); ++f) backward(*f, own_);
  forEachSubtree([&](int t) {
    for (auto f = subtree_[at(t)].rbegin(); f != subtree_[at(t)].rend(); ++f) backward(*f, own_);
  });
  return end(own_);
}

Eigen::VectorXd MultifrontalCholesky::solveAlone(const Eigen::VectorXd& b, Workspace& workspace) const {
  workspace.x.resize(own_.x.size());
  workspace.rows.resize(own_.rows.size());
  begin(b, workspace);
  const int fronts = static_cast<int>(layout_.size());
  for (int f = 0; f < fronts; ++f) forward(f, workspace);
  for (int f = fronts; f-- > 0;) backward(f, workspace);
  return end(workspace);
}

}  // namespace slom
