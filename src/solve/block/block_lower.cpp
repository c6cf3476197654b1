#include "block_lower.hpp"

#include <algorithm>

#include <Eigen/Core>

#include "base/index.hpp"

namespace slom {

void BlockLower::layOut(const BlockGraph& graph, const std::vector<int>& position) {
  const int n = graph.size();
  std::vector<int> node(at(n));
  dof_.resize(at(n));
  for (int b = 0; b < n; ++b) {
    node[at(position[at(b)])] = b;
    dof_[at(position[at(b)])] = graph.dof[at(b)];
  }
  column_.assign(1, 0);
  column_.reserve(at(n) + 1);
  row_.clear();
  row_.reserve(at(n) + graph.neighbour.size());
  for (int j = 0; j < n; ++j) {
    const int b = node[at(j)];
    row_.push_back(j);
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) {
      const int i = position[at(graph.neighbour[at(e)])];
      if (i > j) row_.push_back(i);
    }
    std::sort(row_.begin() + column_.back(), row_.end());
    column_.push_back(static_cast<int>(row_.size()));
  }
  row_.shrink_to_fit();
  start_.resize(row_.size() + 1);
  std::size_t next = 0;
  for (int j = 0; j < n; ++j) {
    start_[at(begin(j))] = next;
    next += at(dof(j)) * at(dof(j));
  }
  diagonal_size_ = next;
  for (int j = 0; j < n; ++j) {
    for (int k = begin(j) + 1; k < begin(j + 1); ++k) {
      start_[at(k)] = next;
      next += at(dof(j)) * at(dof(row_[at(k)]));
    }
  }
  start_.back() = next;
  values_.resize(start_.back());
}

void BlockLower::layOutAs(const BlockLower& other) {
  dof_ = other.dof_;
  column_ = other.column_;
  row_ = other.row_;
  start_ = other.start_;
  diagonal_size_ = other.diagonal_size_;
  values_.resize(start_.back());
}

int BlockLower::find(int i, int j) const {
  const auto first = row_.begin() + begin(j), last = row_.begin() + begin(j + 1);
  return static_cast<int>(std::lower_bound(first, last, i) - row_.begin());
}

double BlockLower::squaredForm(const std::vector<int>& offset, const double* x) const {
  using Eigen::Map;
  double sum = 0;
  for (int j = 0; j < columns(); ++j) {
    const Map<const Eigen::VectorXd> xj(x + offset[at(j)], dof(j));
    for (int k = begin(j); k < begin(j + 1); ++k) {
      const int i = row(k);
      const Map<const Eigen::VectorXd> xi(x + offset[at(i)], dof(i));
      const double part = xi.dot(Map<const Eigen::MatrixXd>(values(k), dof(i), dof(j)).lazyProduct(xj));
      sum += i == j ? part : 2 * part;
    }
  }
  return sum;
}

}  // namespace slom
