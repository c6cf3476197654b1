#include "schur_complement.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/index.hpp"
#include "base/threads.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/symbolic/independent_blocks.hpp"

namespace slom {

namespace {

/// Number of remaining blocks up to which a table gives the block of S at a place. With more, the block is searched
/// for.
constexpr int kMostInTable = 1024;
/// Number of eliminated blocks that are processed together, so that shared data stay in the cache.
constexpr int kPerWave = 128;
/// Largest number of entries of a further private accumulator of S per pair of blocks, so that a single thread loses
/// little.
constexpr double kEntriesPerPair = 0.2;
constexpr int kMostPartitions = 8;
/// Number of pairs in a wave below which threads do not share them.
constexpr int kFewestSharedPairs = 1 << 14;

}  // namespace

SchurComplement::SchurComplement(const BlockLower& H, int eliminated, double flops, const BlockGraph& reduced,
                                 const std::vector<int>& position)
    : flops_(flops) {
  eliminated_.analyze(H, eliminated);
  S_.layOut(reduced, position);
  const int n = S_.columns();
  for (int j = 0; j < n; ++j) column_.resize(at(S_.begin(j + 1)), j);
  copied_.assign(at(S_.begin(n)), -1);
  for (int j = 0; j < n; ++j) {
    for (int k = H.begin(eliminated + j); k < H.begin(eliminated + j + 1); ++k)
      copied_[at(S_.find(H.row(k) - eliminated, j))] = k;
  }
  for (int e = 0; e < eliminated; ++e) depth_ = std::max(depth_, H.dof(e));
  reduced_.assign(1, 0);
  for (int e = 0; e < eliminated; ++e) {
    std::size_t entries = at(vectorSize());
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k)
      entries += at(depth_ * dense::paddedRows(H.dof(H.row(k))));
    reduced_.push_back(reduced_.back() + entries);
  }
  for (int wave = 0; wave < eliminated; wave += kPerWave) {
    largest_ = std::max(largest_, reduced_[at(std::min(wave + kPerWave, eliminated))] - reduced_[at(wave)]);
  }
  offset_.assign(1, 0);
  for (int j = 0; j < n; ++j) offset_.push_back(offset_.back() + S_.dof(j));
  listPairs(H);
  partitions_ = choosePartitions();
  Y_.resize(at(partitions_) * largest_);
  accumulators_.resize(at(partitions_ - 1) * (S_.size() + at(offset_.back())));
}

int SchurComplement::waves() const { return (eliminated_.count() + kPerWave - 1) / kPerWave; }

int SchurComplement::choosePartitions() const {
  const double entries = static_cast<double>(S_.size()) + offset_.back();
  const double affordable = entries > 0 ? kEntriesPerPair * static_cast<double>(pair_.size()) / entries : 0;
  return std::max(1, std::min({1 + static_cast<int>(std::min<double>(affordable, kMostPartitions)),
                               kMostPartitions, waves()}));
}

/// Finder and counter of blocks of S.
class SchurComplement::Places {
 public:
  explicit Places(const BlockLower& S) : count(at(S.begin(S.columns()) + S.columns()), 0), S_(S) {
    const int n = S.columns();
    if (n > kMostInTable) return;
    table_.assign(at(n) * at(n), -1);
    for (int j = 0; j < n; ++j) {
      for (int k = S.begin(j); k < S.begin(j + 1); ++k) table_[at(S.row(k)) * at(n) + at(j)] = k;
    }
  }
  int find(int row, int column) const {
    return table_.empty() ? S_.find(row, column) : table_[at(row) * at(S_.columns()) + at(column)];
  }

  std::vector<int> count;  // number of pairs of each block and of each right-hand side
  std::vector<int> found;  // block of each pair of a wave

 private:
  const BlockLower& S_;
  std::vector<int> table_;  // if there are few blocks
};

void SchurComplement::listPairs(const BlockLower& H) {
  std::size_t pairs = 0;
  for (int e = 0; e < eliminated_.count(); ++e) {
    const std::size_t neighbours = at(H.begin(e + 1) - H.begin(e) - 1);
    pairs += neighbours * (neighbours + 3) / 2;
  }
  pair_ = std::vector<dense::Pair>();
  pair_.reserve(pairs);
  meeting_.clear();
  first_meeting_.assign(1, 0);
  Places places(S_);
  for (int wave = 0; wave < eliminated_.count(); wave += kPerWave) {
    listWave(H, wave, places);
    first_meeting_.push_back(static_cast<int>(meeting_.size()));
  }
  meeting_.push_back({-1, static_cast<int>(pair_.size())});
}

/// Lists the pairs of a wave, sorted by block, by counting.
void SchurComplement::listWave(const BlockLower& H, int wave, Places& places) {
  const int end = std::min(wave + kPerWave, eliminated_.count());
  const auto first = static_cast<std::ptrdiff_t>(meeting_.size());
  places.found.clear();
  const auto count = [&](int block) {
    if (places.count[at(block)]++ == 0) meeting_.push_back({block, 0});
    places.found.push_back(block);
  };
  for (int e = wave; e < end; ++e) {
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
      const int row = H.row(k) - eliminated_.count();
      count(S_.begin(S_.columns()) + row);
      for (int l = H.begin(e) + 1; l <= k; ++l) count(places.find(row, H.row(l) - eliminated_.count()));
    }
  }
  std::sort(meeting_.begin() + first, meeting_.end(),
            [](const Meeting& a, const Meeting& b) { return a.block < b.block; });
  int next = static_cast<int>(pair_.size());
  for (auto meeting = meeting_.begin() + first; meeting != meeting_.end(); ++meeting) {
    meeting->first = next;
    next += std::exchange(places.count[at(meeting->block)], next);
  }
  pair_.resize(at(next));
  auto block = places.found.begin();
  for (int e = wave; e < end; ++e) {
    const auto width = [&](int k) {
      return static_cast<std::uint32_t>(depth_ * dense::paddedRows(H.dof(H.row(k))) / dense::kRowPadding);
    };
    const auto begin =
        static_cast<std::uint32_t>((reduced_[at(e)] - reduced_[at(wave)]) / dense::kRowPadding);
    const auto add = [&](std::uint32_t a, std::uint32_t b) {
      pair_[at(places.count[at(*block++)]++)] = {a, b};
    };
    const std::uint32_t behind = begin + static_cast<std::uint32_t>(vectorSize() / dense::kRowPadding);
    std::uint32_t Yi = behind;
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); Yi += width(k++)) {
      add(Yi, begin);
      std::uint32_t Yj = behind;
      for (int l = H.begin(e) + 1; l <= k; Yj += width(l++)) add(Yi, Yj);
    }
  }
  for (auto meeting = meeting_.begin() + first; meeting != meeting_.end(); ++meeting)
    places.count[at(meeting->block)] = 0;
}

/// Computes Y := W L^-T for each neighbour of e, with padded columns. If e is smaller than others, appends columns of
/// 0.
void SchurComplement::halfReduce(const BlockLower& H, int e, double* Y) const {
  const auto solve_right = dense::kernels().solveRight;
  const int d = H.dof(e);
  for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) {
    const int height = H.dof(H.row(k)), rows = dense::paddedRows(height);
    solve_right(d, height, eliminated_.factor(e), H.values(k), Y);
    std::fill_n(Y + d * rows, (depth_ - d) * rows, 0.0);
    Y += depth_ * rows;
  }
}

/// Computes y := (L^-1 b)^T, padded in the same way.
void SchurComplement::halfReduce(const double* b, int e, int d, double* y) const {
  double solved[kLargestIndependent] = {};
  std::copy_n(b, d, solved);
  eliminated_.forward(e, d, solved);
  for (int c = 0; c < depth_; ++c) y[c * dense::paddedRows(1)] = c < d ? solved[c] : 0;
}

/// Sets S := H_cc.
void SchurComplement::start(const BlockLower& H) {
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
}

EliminatedBlocks::Failure SchurComplement::reduceWave(const BlockLower& H, const std::vector<int>& offset,
                                                      const Eigen::VectorXd& damping, double tolerance,
                                                      int wave, const Eigen::VectorXd* b,
                                                      const Target& target, double* Y) {
  const int begin = wave * kPerWave, end = std::min(begin + kPerWave, eliminated_.count());
  const auto failure = eliminated_.factorize(H, begin, end, offset, damping, tolerance);
  if (failure.happened()) return failure;
  for (int e = begin; e < end; ++e) {
    double* const Y_e = Y + (reduced_[at(e)] - reduced_[at(begin)]);
    if (b != nullptr) halfReduce(b->data() + offset[at(e)], e, H.dof(e), Y_e);
    halfReduce(H, e, Y_e + vectorSize());
  }
  // Each block adds up its terms in registers.
  const auto subtract_outers = dense::kernels().subtractOuters;
  const int blocks = S_.begin(S_.columns());
  const int first_meeting = first_meeting_[at(wave)], last_meeting = first_meeting_[at(wave + 1)];
  const auto take = [&](int m) {
    const Meeting& meeting = meeting_[at(m)];
    const int pairs = meeting_[at(m + 1)].first - meeting.first, row = meeting.block - blocks;
    const dense::Pair* const pair = &pair_[at(meeting.first)];
    if (row < 0) {
      subtract_outers(depth_, S_.dof(S_.row(meeting.block)), S_.dof(column_[at(meeting.block)]), pairs, pair,
                      Y, target.S + (S_.values(meeting.block) - S_.values(0)));
    } else if (b != nullptr) {
      subtract_outers(depth_, S_.dof(row), 1, pairs, pair, Y, target.b + target.offset[row]);
    }
  };
  const bool is_shared =
      partitions_ == 1 &&
      meeting_[at(last_meeting)].first - meeting_[at(first_meeting)].first >= kFewestSharedPairs;
  if (is_shared) {
    detail::forEachIndex(last_meeting - first_meeting, [&](int m) { take(first_meeting + m); });
  } else {
    for (int m = first_meeting; m < last_meeting; ++m) take(m);
  }
  return {};
}

SolveStatus SchurComplement::reduce(const BlockLower& H, const std::vector<int>& offset,
                                    const Eigen::VectorXd& damping, double tolerance, Eigen::VectorXd* b) {
  start(H);
  if (eliminated_.count() == 0) return {};
  const std::size_t entries = S_.size() + at(offset_.back());
  const Target whole{S_.values(0), b == nullptr ? nullptr : b->data(), offset.data() + eliminated_.count()};
  const auto target = [&](int partition) {
    if (partition == 0) return whole;
    double* const accumulator = accumulators_.data() + at(partition - 1) * entries;
    return Target{accumulator, accumulator + S_.size(), offset_.data()};
  };
  std::vector<EliminatedBlocks::Failure> failures(at(partitions_));
  detail::forEachIndex(partitions_, [&](int partition) {
    if (partition > 0) std::fill_n(target(partition).S, entries, 0.0);
    const int last = static_cast<int>(std::int64_t{waves()} * (partition + 1) / partitions_);
    for (int wave = static_cast<int>(std::int64_t{waves()} * partition / partitions_); wave < last; ++wave) {
      failures[at(partition)] = reduceWave(H, offset, damping, tolerance, wave, b, target(partition),
                                           Y_.data() + at(partition) * largest_);
      if (failures[at(partition)].happened()) return;
    }
  });
  for (const EliminatedBlocks::Failure& failure : failures) {
    if (failure.happened()) return EliminatedBlocks::status(failure, offset);
  }
  const auto add = [](const double* x, Eigen::Index n, double* sum) {
    Eigen::Map<Eigen::ArrayXd>(sum, n) += Eigen::Map<const Eigen::ArrayXd>(x, n);
  };
  for (int partition = 1; partition < partitions_; ++partition) {
    const Target from = target(partition);
    add(from.S, static_cast<Eigen::Index>(S_.size()), whole.S);
    for (int j = 0; b != nullptr && j < S_.columns(); ++j)
      add(from.b + from.offset[j], S_.dof(j), whole.b + whole.offset[j]);
  }
  return {};
}

void SchurComplement::forward(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const {
  eliminated_.reduceVector(H, offset, x);
}

void SchurComplement::substitute(const BlockLower& H, const std::vector<int>& offset,
                                 Eigen::VectorXd& x) const {
  eliminated_.substitute(H, offset, x);
}

void SchurComplement::invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const {
  detail::forEachIndex(count(), [&](int e) { eliminated_.invert(H, e, Z, inverse); });
}

}  // namespace slom
