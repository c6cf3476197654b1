/// Plan made before any number is known: places of panels and updates, who adds to whom, and which fronts run in
/// parallel.
#include <algorithm>
#include <map>

#include "base/index.hpp"
#include "base/threads.hpp"
#include "multifrontal.hpp"
#include "solve/dense/child_rows.hpp"

namespace slom {

namespace {

using dense::kStripe;
using dense::stripesOf;

/// Largest fraction of the whole work that one subtree may have; larger ones are cut.
constexpr double kLargestSubtree = 1.0 / 16;
/// Places in an array for pieces of changing lifetime; first fit.
class Planner {
 public:
  std::size_t take(std::size_t size) {
    for (auto gap = gaps_.begin(); gap != gaps_.end(); ++gap) {
      if (gap->second < size) continue;
      const auto [begin, length] = *gap;
      gaps_.erase(gap);
      if (length > size) gaps_.emplace(begin + size, length - size);
      return begin;
    }
    end_ += size;
    return end_ - size;
  }
  void giveBack(std::size_t begin, std::size_t size) {
    if (size == 0) return;
    auto gap = gaps_.emplace(begin, size).first;
    const auto next = std::next(gap);
    if (next != gaps_.end() && gap->first + gap->second == next->first) {
      gap->second += next->second;
      gaps_.erase(next);
    }
    if (gap == gaps_.begin()) return;
    const auto before = std::prev(gap);
    if (before->first + before->second != gap->first) return;
    before->second += gap->second;
    gaps_.erase(gap);
  }
  std::size_t end() const { return end_; }

 private:
  std::map<std::size_t, std::size_t> gaps_;  // begin -> length
  std::size_t end_ = 0;
};

}  // namespace

double MultifrontalCholesky::work(const Front& front) { return frontFlops(front.p, front.u); }

void MultifrontalCholesky::analyze(const std::vector<int>& offset, Fronts fronts, const BlockLower& H) {
  fronts_ = std::move(fronts);
  const std::size_t n = at(fronts_.offset.back());
  unknown_.clear();
  for (std::size_t j = 0; j < fronts_.order.size(); ++j) {
    for (int i = 0; i < fronts_.offset[j + 1] - fronts_.offset[j]; ++i) {
      unknown_.push_back(offset[at(fronts_.order[j])] + i);
    }
  }
  layOut();
  relate();
  findEntries(H);
  cutIntoSubtrees();
  planUpdates(detail::threadCount() == 1);
  inverse_.assign(n, 0.0);
  least_.assign(n, 0.0);
  shift_.assign(n, 0.0);
  own_.x.assign(n, 0.0);
}

void MultifrontalCholesky::layOut() {
  const int n = static_cast<int>(fronts_.front.size());
  layout_.assign(at(n), {});
  std::vector<int> count(at(n) + 1, 0);
  std::size_t size = 0, vector = 0;
  for (int f = 0; f < n; ++f) {
    const Front& front = fronts_.front[at(f)];
    Layout& layout = layout_[at(f)];
    layout.D = size;
    layout.B = size += dense::panelSize(front.p, front.p);
    size += dense::panelSize(front.u, front.p);
    layout.vector = vector;
    vector += at(kStripe * stripesOf(front.u));
    if (front.parent >= 0) ++count[at(front.parent) + 1];
  }
  L_.resize(size);
  own_.rows.assign(vector, 0.0);
  for (int f = 0; f < n; ++f) {
    count[at(f) + 1] += count[at(f)];
    layout_[at(f)].first_child = layout_[at(f)].last_child = count[at(f)];
  }
  children_.resize(at(count.back()));
  for (int f = 0; f < n; ++f) {
    const int parent = fronts_.front[at(f)].parent;
    if (parent >= 0) children_[at(layout_[at(parent)].last_child++)] = f;
  }
}

/// Finds the places of the rows of each front in its parent.
void MultifrontalCholesky::relate() {
  runs_.clear();
  relative_.clear();
  std::vector<int> local(fronts_.order.size(),
                         0);  // first row of each position in the current front
  dense::ChildRows rows;
  const auto dof = [&](int position) {
    return fronts_.offset[at(position) + 1] - fronts_.offset[at(position)];
  };
  for (std::size_t f = 0; f < fronts_.front.size(); ++f) {
    const Front& front = fronts_.front[f];
    int next = 0;
    for (int j = front.first_column; j < front.last_column; ++j) {
      local[at(j)] = next;
      next += dof(j);
    }
    for (int r = front.first_row; r < front.last_row; ++r) {
      local[at(fronts_.row[at(r)])] = next;
      next += dof(fronts_.row[at(r)]);
    }
    for (int c = layout_[f].first_child; c < layout_[f].last_child; ++c) {
      const Front& child = fronts_.front[at(children_[at(c)])];
      Layout& layout = layout_[at(children_[at(c)])];
      layout.relative = relative_.size();
      layout.first_run = static_cast<int>(runs_.size());
      rows.clear();
      for (int r = child.first_row; r < child.last_row; ++r)
        rows.add(local[at(fronts_.row[at(r)])], dof(fronts_.row[at(r)]), front.p);
      rows.finish(front.p);
      runs_.insert(runs_.end(), rows.runs.begin(), rows.runs.end());
      relative_.insert(relative_.end(), rows.columns.begin(), rows.columns.end());
      layout.last_run = static_cast<int>(runs_.size());
    }
  }
}

void MultifrontalCholesky::findEntries(const BlockLower& H) {
  entries_.clear();
  std::vector<int> local(fronts_.order.size(), 0);
  for (std::size_t f = 0; f < fronts_.front.size(); ++f) {
    const Front& front = fronts_.front[f];
    const int origin = fronts_.offset[at(front.first_column)];
    int next = front.p;
    for (int r = front.first_row; r < front.last_row; ++r) {
      const int position = fronts_.row[at(r)];
      local[at(position)] = next;
      next += fronts_.offset[at(position) + 1] - fronts_.offset[at(position)];
    }
    layout_[f].first_entry = static_cast<int>(entries_.size());
    for (int j = front.first_column; j < front.last_column; ++j) {
      for (int k = H.begin(j); k < H.begin(j + 1); ++k) {
        const int i = H.row(k);
        const int row = i < front.last_column ? fronts_.offset[at(i)] - origin : local[at(i)];
        entries_.push_back({k, row, fronts_.offset[at(j)] - origin,
                            fronts_.offset[at(i) + 1] - fronts_.offset[at(i)],
                            fronts_.offset[at(j) + 1] - fronts_.offset[at(j)]});
      }
    }
    layout_[f].last_entry = static_cast<int>(entries_.size());
  }
}

void MultifrontalCholesky::cutIntoSubtrees() {
  const int n = static_cast<int>(fronts_.front.size());
  std::vector<double> below(at(n), 0.0);
  double all = 0;
  for (int f = 0; f < n; ++f) {
    below[at(f)] += work(fronts_.front[at(f)]);
    all += work(fronts_.front[at(f)]);
    if (fronts_.front[at(f)].parent >= 0) below[at(fronts_.front[at(f)].parent)] += below[at(f)];
  }
  const double most = std::max(all * kLargestSubtree, kSmallestTask);
  subtree_of_.assign(at(n), -1);
  subtree_.clear();
  // The loop goes down from the roots: a subtree gets its number at its root.
  double filled = most;
  for (int f = n - 1; f >= 0; --f) {
    const int parent = fronts_.front[at(f)].parent;
    if (parent >= 0 && subtree_of_[at(parent)] >= 0) {
      subtree_of_[at(f)] = subtree_of_[at(parent)];
    } else if (below[at(f)] <= most) {
      // Small neighbouring subtrees share a task.
      if (filled + below[at(f)] > most) {
        subtree_.emplace_back();
        filled = 0;
      }
      filled += below[at(f)];
      subtree_of_[at(f)] = static_cast<int>(subtree_.size()) - 1;
    }
  }
  const int top = static_cast<int>(subtree_.size());
  subtree_.emplace_back();
  for (int f = 0; f < n; ++f) {
    if (subtree_of_[at(f)] < 0) subtree_of_[at(f)] = top;
    subtree_[at(subtree_of_[at(f)])].push_back(f);
  }
}

/// Plans the places of updates, which live until the parent has taken them. Threads that work on different subtrees
/// must not share places. One thread alone goes from front to front, so all later updates reuse the places.
void MultifrontalCholesky::planUpdates(bool is_sequential) {
  is_sequential_ = is_sequential;
  std::size_t origin = 0;
  Planner planner;
  const auto plan = [&](int f) {
    Layout& layout = layout_[at(f)];
    layout.U = origin + planner.take(dense::updateSize(fronts_.front[at(f)].u));
    for (int c = layout.first_child; c < layout.last_child; ++c) {
      const int child = children_[at(c)];
      if (!is_sequential && subtree_of_[at(child)] != subtree_of_[at(f)]) continue;
      planner.giveBack(layout_[at(child)].U - origin, dense::updateSize(fronts_.front[at(child)].u));
    }
  };
  if (is_sequential) {
    for (int f = 0; f < static_cast<int>(layout_.size()); ++f) plan(f);
    origin = planner.end();
  } else {
    for (const std::vector<int>& subtree : subtree_) {
      for (const int f : subtree) plan(f);
      origin += planner.end();
      planner = Planner();
    }
  }
  updates_.resize(origin);
}

}  // namespace slom
