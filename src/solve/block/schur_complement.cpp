#include "schur_complement.hpp"

#include <algorithm>
#include <cmath>

#include "linearize/parallel.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Fewer are left to the ordering.
constexpr int kFewestEliminated = 64;
constexpr int kLargestEliminated = 3;  // degrees of freedom
/// In graphs without such a structure, paths for one, fewer of all blocks are independent.
constexpr double kLeastShare = 2.0 / 3;
/// With more blocks left, the block of S at a place is searched for instead of looked up.
constexpr int kMostInTable = 2048;
/// Eliminated blocks that are worked on together, so that what they share stays in the cache.
constexpr int kBlocksPerWave = 2048;

}  // namespace

std::vector<char> independentBlocks(const BlockGraph& graph) {
  const auto degree = [&](int b) { return graph.start[at(b) + 1] - graph.start[at(b)]; };
  std::vector<int> candidates;
  for (int b = 0; b < graph.size(); ++b) {
    if (graph.dof[at(b)] <= kLargestEliminated) candidates.push_back(b);
  }
  if (static_cast<int>(candidates.size()) < kFewestEliminated) return {};
  std::stable_sort(candidates.begin(), candidates.end(), [&](int a, int b) { return degree(a) < degree(b); });
  std::vector<char> eliminated(at(graph.size()), 0);
  int count = 0;
  for (const int b : candidates) {
    const auto first = graph.neighbour.begin() + graph.start[at(b)];
    if (std::any_of(first, first + degree(b), [&](int c) { return eliminated[at(c)] != 0; })) continue;
    eliminated[at(b)] = 1;
    ++count;
  }
  if (count < kFewestEliminated || count < kLeastShare * graph.size()) return {};
  return eliminated;
}

ReducedGraph reduceGraph(const BlockGraph& graph, const std::vector<char>& eliminated) {
  ReducedGraph result;
  std::vector<int> node(at(graph.size()), -1), mark;
  for (int b = 0; b < graph.size(); ++b) {
    if (eliminated[at(b)]) continue;
    node[at(b)] = static_cast<int>(result.block.size());
    result.block.push_back(b);
    result.graph.dof.push_back(graph.dof[at(b)]);
  }
  mark.assign(result.block.size(), -1);
  result.graph.start.push_back(0);
  std::vector<int>& neighbour = result.graph.neighbour;
  for (int i = 0; i < static_cast<int>(result.block.size()); ++i) {
    const int b = result.block[at(i)];
    const std::size_t first = neighbour.size();
    mark[at(i)] = i;
    const auto add = [&](int j) {
      if (mark[at(j)] == i) return;
      mark[at(j)] = i;
      neighbour.push_back(j);
    };
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) {
      const int c = graph.neighbour[at(e)];
      if (!eliminated[at(c)]) {
        add(node[at(c)]);
      } else {
        for (int f = graph.start[at(c)]; f < graph.start[at(c) + 1]; ++f) add(node[at(graph.neighbour[at(f)])]);
      }
    }
    std::sort(neighbour.begin() + static_cast<std::ptrdiff_t>(first), neighbour.end());
    result.graph.start.push_back(static_cast<int>(neighbour.size()));
  }
  return result;
}

void SchurComplement::analyze(const BlockLower& H, int eliminated, const BlockGraph& reduced, const std::vector<int>& position) {
  eliminated_.analyze(H, eliminated);
  S_.layOut(reduced, position);
  const int n = S_.columns();
  table_.clear();
  if (n <= kMostInTable) {
    table_.assign(at(n) * at(n), -1);
    for (int j = 0; j < n; ++j) {
      for (int k = S_.begin(j); k < S_.begin(j + 1); ++k) table_[at(S_.row(k)) * at(n) + at(j)] = k;
    }
  }
  copied_.assign(at(S_.begin(n)), -1);
  for (int j = 0; j < n; ++j) {
    for (int k = H.begin(eliminated + j); k < H.begin(eliminated + j + 1); ++k) copied_[at(target(H.row(k) - eliminated, j))] = k;
  }
  reduced_.assign(1, 0);
  work_.assign(at(n) + 1, 0.0);
  for (int e = 0; e < eliminated; ++e) {
    const std::size_t d = at(H.dof(e));
    std::size_t entries = 0;
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
      entries += d * at(dense::paddedRows(H.dof(H.row(k))));
      work_[at(H.row(k) - eliminated) + 1] += k - H.begin(e);
    }
    reduced_.push_back(reduced_.back() + entries);
  }
  for (std::size_t i = 1; i < work_.size(); ++i) work_[i] += work_[i - 1];
}

int SchurComplement::target(int row, int column) const {
  return table_.empty() ? S_.find(row, column) : table_[at(row) * at(S_.columns()) + at(column)];
}

/// For each neighbour of e: Y := W L^-T, with filled-up columns.
void SchurComplement::halfReduce(const BlockLower& H, int e, double* Y) const {
  const auto solve_right = dense::kernels().solveRight;
  const int d = H.dof(e);
  for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
    const int height = H.dof(H.row(k));
    solve_right(d, height, eliminated_.factor(e), H.values(k), Y);
    Y += d * dense::paddedRows(height);
  }
}

/// S_ij -= Y_i Y_j^T for the neighbours i >= j of e with row first <= i < last.
void SchurComplement::subtractOuter(const BlockLower& H, int e, const double* Y, int first, int last) {
  const auto subtract_outer = dense::kernels().subtractOuter;
  const int d = H.dof(e);
  const double* Yi = Y;
  for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
    const int i = H.row(k) - eliminated_.count(), height = S_.dof(i);
    if (i >= last) break;
    if (i >= first) {
      const double* Yj = Y;
      for (int l = H.begin(e) + 1; l <= k; ++l) {
        const int j = H.row(l) - eliminated_.count();
        subtract_outer(d, height, S_.dof(j), Yi, Yj, S_.values(target(i, j)));
        Yj += d * dense::paddedRows(S_.dof(j));
      }
    }
    Yi += d * dense::paddedRows(height);
  }
}

SolveStatus SchurComplement::reduce(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping,
                                    double tolerance) {
  detail::forEachIndex(S_.columns(), [&](int j) {
    for (int k = S_.begin(j); k < S_.begin(j + 1); ++k) {
      const std::size_t size = at(S_.dof(j)) * at(S_.dof(S_.row(k)));
      if (copied_[at(k)] < 0) {
        std::fill_n(S_.values(k), size, 0.0);
      } else {
        std::copy_n(H.values(copied_[at(k)]), size, S_.values(k));
      }
    }
  });
  constexpr int kPerTask = 64;
  const int count = eliminated_.count();
  for (int wave = 0; wave < count; wave += kBlocksPerWave) {
    const int end = std::min(wave + kBlocksPerWave, count);
    Y_.resize(std::max(Y_.size(), reduced_[at(end)] - reduced_[at(wave)]));
    const auto Y = [&](int e) { return Y_.data() + (reduced_[at(e)] - reduced_[at(wave)]); };
    std::vector<EliminatedBlocks::Failure> failures(at((end - wave + kPerTask - 1) / kPerTask));
    detail::forEachIndex(static_cast<int>(failures.size()), [&](int task) {
      const int first = wave + task * kPerTask, last = std::min(end, first + kPerTask);
      failures[at(task)] = eliminated_.factorize(H, first, last, offset, damping, tolerance);
      if (failures[at(task)].happened()) return;
      for (int e = first; e < last; ++e) halfReduce(H, e, Y(e));
    });
    for (const EliminatedBlocks::Failure& failure : failures) {
      if (failure.happened()) return EliminatedBlocks::status(failure, offset);
    }
    detail::forEachRange(work_, tbb::this_task_arena::max_concurrency(), [&](int first, int last) {
      for (int e = wave; e < end; ++e) subtractOuter(H, e, Y(e), first, last);
    });
  }
  return {};
}

}  // namespace slom
