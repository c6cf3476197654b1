#include "partial_minimum_degree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "base/index.hpp"

namespace slom {

namespace {

/// Number of eliminated blocks, and fraction of all blocks, below which the ordering handles them.
constexpr int kFewestOfMinimumDegree = 16;
constexpr double kLeastShareOfMinimumDegree = 0.2;
/// Number of neighbours above which a block's neighbours are not eliminated, because searching its list takes too long.
constexpr int kMostNeighbours = 48;

/// The graph during elimination, with lists of neighbours. A list that grows moves to the end of the storage.
class GraphElimination {
 public:
  explicit GraphElimination(const BlockGraph& graph)
      : dof_(graph.dof),
        first_(graph.start.begin(), graph.start.end() - 1),
        count_(at(graph.size())),
        room_(at(graph.size())),
        rows_(at(graph.size()), 0),
        round_(at(graph.size()), -1),
        place_(at(graph.size()), 0),
        neighbour_(graph.neighbour) {
    for (int b = 0; b < graph.size(); ++b) {
      count_[at(b)] = room_[at(b)] = graph.start[at(b) + 1] - graph.start[at(b)];
      for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e)
        rows_[at(b)] += dof_[at(neighbour_[at(e)])];
      offer(b);
    }
  }

  std::vector<int> run() {
    std::vector<int> order;
    for (int round = 0;; ++round) {
      const auto lowest =
          std::find_if(waiting_.begin(), waiting_.end(), [](const auto& list) { return !list.empty(); });
      if (lowest == waiting_.end()) return order;
      const int rows = static_cast<int>(lowest - waiting_.begin());
      std::vector<int> candidates;
      candidates.swap(*lowest);
      for (const int b : candidates) {
        if (rows_[at(b)] != rows || is_gone(b)) continue;
        if (round_[at(b)] == round) {
          lowest->push_back(b);  // it met a block of this round
          continue;
        }
        if (eliminate(b, round)) order.push_back(b);
      }
    }
  }

  bool is_gone(int b) const { return room_[at(b)] < 0; }
  const int* begin(int b) const { return neighbour_.data() + first_[at(b)]; }
  const int* end(int b) const { return begin(b) + count_[at(b)]; }

 private:
  void offer(int b) {
    if (rows_[at(b)] <= kMostRowsBelow && dof_[at(b)] <= kMostColumns)
      waiting_[at(rows_[at(b)])].push_back(b);
  }

  bool eliminate(int b, int round) {
    const auto is_large = [&](int c) { return count_[at(c)] > kMostNeighbours; };
    if (std::any_of(begin(b), end(b), is_large)) return false;
    room_[at(b)] = -1;
    const int count = count_[at(b)];
    int own[kMostRowsBelow];  // a copy: lists move when they grow
    std::copy_n(begin(b), count, own);
    for (int i = 0; i < count; ++i) place_[at(own[i])] = i;
    for (int i = 0; i < count; ++i) {
      const int c = own[i], before = rows_[at(c)];
      connect(c, b, own, count);
      round_[at(c)] = round;
      if (rows_[at(c)] != before) offer(c);
    }
    return true;
  }

  /// Replaces b by the `count` blocks in `own` in the list of c, which is one of them. place_ gives their indices.
  void connect(int c, int b, const int* own, int count) {
    std::uint32_t has = std::uint32_t{1} << place_[at(c)];
    int* const list = neighbour_.data() + first_[at(c)];
    int found = 0;
    for (int i = 0; i < count_[at(c)]; ++i) {
      const int other = list[i], place = place_[at(other)];  // undefined for blocks that are not in `own`
      if (other == b) found = i;
      if (place < count && own[place] == other) has |= std::uint32_t{1} << place;
    }
    list[found] = list[--count_[at(c)]];
    rows_[at(c)] -= dof_[at(b)];
    for (std::uint32_t lacks = ~has & ((std::uint32_t{1} << count) - 1); lacks != 0; lacks &= lacks - 1) {
      append(c, own[std::countr_zero(lacks)]);
    }
  }

  void append(int c, int b) {
    if (count_[at(c)] == room_[at(c)]) {
      const int moved = static_cast<int>(neighbour_.size());
      room_[at(c)] = 2 * room_[at(c)] + 2;
      neighbour_.resize(neighbour_.size() + at(room_[at(c)]));
      std::copy(begin(c), end(c), neighbour_.begin() + moved);
      first_[at(c)] = moved;
    }
    neighbour_[at(first_[at(c)] + count_[at(c)]++)] = b;
    rows_[at(c)] += dof_[at(b)];
  }

  const std::vector<int>& dof_;
  std::vector<int> first_, count_, room_;  // by block: range of its neighbours; room -1: eliminated
  std::vector<int> rows_;                  // by block: degrees of freedom of its neighbours
  std::vector<int> round_;                 // by block: last round in which a neighbour was eliminated
  std::vector<int> place_;                 // by neighbour of the block being eliminated: its index
  std::vector<int> neighbour_;
  std::array<std::vector<int>, kMostRowsBelow + 1> waiting_;  // blocks by rows; some entries are outdated
};

}  // namespace

PartialMinimumDegree eliminateByMinimumDegree(const BlockGraph& graph) {
  PartialMinimumDegree result;
  GraphElimination elimination(graph);
  result.order = elimination.run();
  const int n = graph.size(), count = static_cast<int>(result.order.size());
  if (count < kFewestOfMinimumDegree || count < kLeastShareOfMinimumDegree * n) return {};
  BlockGraph& filled = result.filled;
  BlockGraph& left = result.left.graph;
  filled.dof = graph.dof;
  filled.start.assign(1, 0);
  left.start.assign(1, 0);
  std::vector<int> node(at(n), -1);
  for (int b = 0; b < n; ++b) {
    if (elimination.is_gone(b)) continue;
    node[at(b)] = static_cast<int>(result.left.block.size());
    result.left.block.push_back(b);
    left.dof.push_back(graph.dof[at(b)]);
  }
  for (int b = 0; b < n; ++b) {
    filled.neighbour.insert(filled.neighbour.end(), elimination.begin(b), elimination.end(b));
    filled.start.push_back(static_cast<int>(filled.neighbour.size()));
    if (elimination.is_gone(b)) continue;
    const auto first = static_cast<std::ptrdiff_t>(left.neighbour.size());
    for (const int* c = elimination.begin(b); c != elimination.end(b); ++c)
      left.neighbour.push_back(node[at(*c)]);
    std::sort(left.neighbour.begin() + first, left.neighbour.end());
    left.start.push_back(static_cast<int>(left.neighbour.size()));
  }
  return result;
}

}  // namespace slom
