#include "partial_elimination.hpp"

#include <algorithm>
#include <numeric>

#include "base/index.hpp"
#include "solve/dense/prefetch.hpp"

namespace slom {

namespace {

/// Number of columns between prefetching and use, if the factor has more numbers than caches hold.
constexpr int kColumnsAhead = 3;
constexpr std::size_t kLargeFactor = 1 << 16;

static_assert(kMostColumns <= dense::kMostEliminated);

}  // namespace

PartialElimination::PartialElimination(const BlockLower& H, const PartialMinimumDegree& blocks,
                                       const std::vector<int>& position)
    : columns_(blocks.order.size()), dof_(blocks.order.size()) {
  const int count = this->count();
  S_.layOut(blocks.left.graph, position);
  layOutFactor(H, count);
  // Returns the place in the factor of a block of H in column e.
  const auto in_factor = [&](int e, int block) {
    const Column& column = columns_[at(e)];
    return block == H.begin(e) ? column.V : column.W + (H.values(block) - H.values(H.begin(e) + 1));
  };
  for (int e = 0; e < count; ++e) {
    Column& column = columns_[at(e)];
    column.first_below = static_cast<int>(row_.size());
    column.first_target = static_cast<int>(target_.size());
    column.below = H.begin(e + 1) - H.begin(e) - 1;
    double rows = H.dof(e);
    for (int k = 0; k < column.below; ++k) {
      row_.push_back(H.row(H.begin(e) + 1 + k));
      height_.push_back(H.dof(row_.back()));
      rows += height_.back();
    }
    target_.resize(target_.size() + at(column.below * (column.below + 1) / 2));
    // Each neighbour's column contains the rows of this column; both are sorted.
    const int* const row = row_.data() + column.first_below;
    for (int l = 0; l < column.below; ++l) {
      const bool is_kept = row[l] >= count;
      const int shift = is_kept ? count : 0;
      const BlockLower& in = is_kept ? S_ : H;
      int block = in.begin(row[l] - shift);
      for (int k = l; k < column.below; ++k) {
        while (in.row(block) != row[k] - shift) ++block;
        double* const target = is_kept ? S_.values(block) : in_factor(row[l], block);
        target_[at(column.first_target + k * (k + 1) / 2 + l)] = target;
      }
    }
    for (int i = 1; i <= H.dof(e); ++i) flops_ += 1 + (rows - i) + (rows - i) * (rows - i + 1);
  }
}

/// Lays out the factor as H: first its diagonal blocks, then those below them.
void PartialElimination::layOutFactor(const BlockLower& H, int count) {
  diagonal_size_ = below_size_ = 0;
  const auto size = [&](int e, int k) { return at(H.dof(e)) * at(H.dof(H.row(k))); };
  for (int e = 0; e < count; ++e) {
    dof_[at(e)] = H.dof(e);
    diagonal_size_ += size(e, H.begin(e));
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) below_size_ += size(e, k);
  }
  factor_.resize(diagonal_size_ + below_size_);
  least_.resize(at(std::accumulate(dof_.begin(), dof_.end(), 0)));
  double *V = factor_.data(), *W = V + diagonal_size_;
  for (int e = 0; e < count; ++e) {
    columns_[at(e)].V = V;
    columns_[at(e)].W = W;
    V += size(e, H.begin(e));
    for (int k = H.begin(e) + 1; k < H.begin(e + 1); ++k) W += size(e, k);
  }
}

SolveStatus PartialElimination::reduce(const BlockLower& H, const std::vector<int>& offset,
                                       const Eigen::VectorXd& damping, double tolerance, Eigen::VectorXd* x) {
  // The diagonal blocks and those below are laid out as parts of H.
  const double* from = H.values(0);
  const auto take = [&](std::size_t size, double* to) {
    std::copy_n(from, size, to);
    from += size;
  };
  take(diagonal_size_, factor_.data());
  take(S_.diagonalSize(), S_.values(0));
  take(below_size_, factor_.data() + diagonal_size_);
  take(S_.size() - S_.diagonalSize(), S_.values(0) + S_.diagonalSize());
  double* least = least_.data();
  for (int e = 0; e < count(); ++e) {
    const int d = dof_[at(e)];
    for (int i = 0; i < d; ++i) {
      double& diagonal = columns_[at(e)].V[i * d + i];
      if (damping.size() > 0) diagonal += damping[offset[at(e)] + i];
      *least++ = tolerance * diagonal;
    }
  }
  const dense::Kernels& kernel = dense::kernels();
  least = least_.data();
  Below below;
  const bool is_large = diagonal_size_ + below_size_ > kLargeFactor;
  for (int e = 0; e < count(); ++e) {
    const Column& column = columns_[at(e)];
    const int d = dof_[at(e)];
    double pivot = 0;
    if (is_large && e + kColumnsAhead < count()) prefetchTargets(columns_[at(e + kColumnsAhead)]);
    if (x != nullptr) findBelow(column, offset, *x, below);
    const int done = kernel.eliminate(d, column.below, height_.data() + column.first_below, column.V,
                                      column.W, target_.data() + column.first_target, least, &pivot,
                                      x != nullptr ? x->data() + offset[at(e)] : nullptr, below.data());
    if (done < d) {
      const double diagonal = least[done] / tolerance;
      return {false, offset[at(e)] + done, diagonal > 0 ? std::max(0.0, pivot / diagonal) : 0.0};
    }
    least += d;
  }
  return {};
}

void PartialElimination::prefetchTargets(const Column& column) const {
  for (int t = 0; t < column.below * (column.below + 1) / 2; ++t) {
    const double* const target = target_[at(column.first_target + t)];
    dense::prefetch(target, target + 9);  // as much as most blocks have
  }
}

void PartialElimination::findBelow(const Column& column, const std::vector<int>& offset, Eigen::VectorXd& x,
                                   Below& below) const {
  for (int i = 0; i < column.below; ++i)
    below[at(i)] = x.data() + offset[at(row_[at(column.first_below + i)])];
}

void PartialElimination::forward(const BlockLower&, const std::vector<int>& offset,
                                 Eigen::VectorXd& x) const {
  const auto forward_column = dense::kernels().forwardColumn;
  Below below;
  for (int e = 0; e < count(); ++e) {
    const Column& column = columns_[at(e)];
    findBelow(column, offset, x, below);
    forward_column(dof_[at(e)], column.below, height_.data() + column.first_below, column.V, column.W,
                   x.data() + offset[at(e)], below.data());
  }
}

void PartialElimination::substitute(const BlockLower&, const std::vector<int>& offset,
                                    Eigen::VectorXd& x) const {
  const auto backward_column = dense::kernels().backwardColumn;
  Below below;
  for (int e = count() - 1; e >= 0; --e) {
    const Column& column = columns_[at(e)];
    findBelow(column, offset, x, below);
    backward_column(dof_[at(e)], column.below, height_.data() + column.first_below, column.V, column.W,
                    below.data(), x.data() + offset[at(e)]);
  }
}

void PartialElimination::invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const {
  using Eigen::MatrixXd;
  using Block = Eigen::Map<const MatrixXd>;
  /// Returns block (i, j) of the inverse, which must be known; i and j are positions in H.
  const auto known = [&](int i, int j) -> MatrixXd {
    const int high = std::max(i, j), low = std::min(i, j);
    const bool is_kept = low >= count();
    const int shift = is_kept ? count() : 0;
    const BlockLower& from = is_kept ? Z : inverse;
    const Block block(from.values(from.find(high - shift, low - shift)), H.dof(high), H.dof(low));
    return i >= j ? MatrixXd(block) : MatrixXd(block.transpose());
  };
  for (int e = count() - 1; e >= 0; --e) {
    const Column& column = columns_[at(e)];
    const int d = dof_[at(e)];
    const Block V(column.V, d, d);
    const MatrixXd L = V.triangularView<Eigen::UnitLower>();
    const MatrixXd L_inverse = L.triangularView<Eigen::UnitLower>().solve(MatrixXd::Identity(d, d));
    const MatrixXd half = V.diagonal().asDiagonal() * L_inverse;  // D^-1 L^-1
    std::vector<MatrixXd> T;                                      // by block below: W V^-1
    const double* W = column.W;
    for (int i = 0; i < column.below; ++i) {
      const int height = height_[at(column.first_below + i)];
      T.emplace_back(Block(W, height, d) * half);
      W += height * d;
    }
    MatrixXd own = L_inverse.transpose() * half;
    for (int i = 0; i < column.below; ++i) {
      const int row = row_[at(column.first_below + i)];
      Eigen::Map<MatrixXd> below(inverse.values(H.begin(e) + 1 + i), H.dof(row), d);
      below.setZero();
      for (int j = 0; j < column.below; ++j)
        below.noalias() -= known(row, row_[at(column.first_below + j)]) * T[at(j)];
      own.noalias() -= T[at(i)].transpose() * below;
    }
    Eigen::Map<MatrixXd>(inverse.values(H.begin(e)), d, d) = (own + own.transpose()) / 2;
  }
}

}  // namespace slom
