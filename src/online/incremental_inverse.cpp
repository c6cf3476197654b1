/// Blocks of the inverse, by solving along two paths of the tree.
///   source   Kaess and Dellaert, "Covariance recovery from a square root information matrix for data association", RAS
///            2009 (the part of the inverse that is needed lies along the path to the root)
#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "online/incremental_cholesky.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

/// Returns the fronts from the one that eliminates the block up to the root.
std::vector<int> IncrementalCholesky::pathFrom(int block) const {
  std::vector<int> path;
  for (int f = blocks_[at(block)].front; f >= 0; f = fronts_[at(f)].parent) path.push_back(f);
  return path;
}

std::vector<std::pair<int, int>> IncrementalCholesky::undeterminedAbove(int block) const {
  std::vector<std::pair<int, int>> found;
  for (const int f : pathFrom(block)) {
    if (fronts_[at(f)].undetermined.empty()) continue;
    for (const int b : fronts_[at(f)].pivots) {
      std::copy(undetermined_.lower_bound({b, 0}), undetermined_.lower_bound({b + 1, 0}),
                std::back_inserter(found));
    }
  }
  return found;
}

std::vector<double> IncrementalCholesky::inverseBlock(int a, int b) const {
  std::vector<double> block;
  for (int c = 0; c < dof(b); ++c) {
    const std::vector<double> column = inverseColumn(a, b, c);
    block.insert(block.end(), column.begin(), column.end());
  }
  return block;
}

/// Returns the entries of block a in the column of H^-1 for a component of block b.
std::vector<double> IncrementalCholesky::inverseColumn(int a, int b, int component) const {
  const auto& kernel = dense::kernels();
  std::map<int, std::vector<double>> entries;  // by block: entries of the unit vector, passed up
  entries[b].assign(at(dof(b)), 0.0);
  entries[b][at(component)] = 1;
  const auto gather = [&](const std::vector<int>& blocks, int count) {
    std::vector<double> x(at(dense::paddedToStripes(count)), 0.0);
    int offset = 0;
    for (const int k : blocks) {
      if (const auto found = entries.find(k); found != entries.end())
        std::copy(found->second.begin(), found->second.end(), x.begin() + offset);
      offset += dof(k);
    }
    return x;
  };
  const auto scatter = [&](const std::vector<int>& blocks, const std::vector<double>& x) {
    int offset = 0;
    for (const int k : blocks) {
      entries[k].assign(x.begin() + offset, x.begin() + offset + dof(k));
      offset += dof(k);
    }
  };
  for (const int f : pathFrom(b)) {  // L y = e
    const Front& front = fronts_[at(f)];
    std::vector<double> y = gather(front.pivots, front.p), rows = gather(front.rows, front.u);
    kernel.forwardPivots(front.D.data(), front.inverse.data(), front.p, y.data());
    if (front.u > 0) {
      std::vector<double> taken(rows.size(), 0.0);
      kernel.forwardRows(front.B.data(), front.p, front.u, y.data(), taken.data());
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += taken[i];
    }
    scatter(front.pivots, y);
    scatter(front.rows, rows);
  }
  std::vector<int> down = pathFrom(a);
  std::reverse(down.begin(), down.end());
  for (const int f : down) {  // L^T x = y
    const Front& front = fronts_[at(f)];
    std::vector<double> x = gather(front.pivots, front.p);
    if (front.u > 0) {
      const std::vector<double> rows = gather(front.rows, front.u);
      kernel.backwardRows(front.B.data(), front.p, front.u, rows.data(), x.data());
    }
    kernel.backwardPivots(front.D.data(), front.inverse.data(), front.p, x.data());
    scatter(front.pivots, x);
  }
  return entries[a];
}

}  // namespace slom
