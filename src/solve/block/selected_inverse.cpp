// Entries of the inverse at the places of the matrix's own blocks, from the root of the tree downwards.
#include "base/index.hpp"
#include "base/threads.hpp"
#include "front_inverse.hpp"
#include "multifrontal.hpp"

namespace slom {

using Eigen::MatrixXd;

/// Returns front f's part of the inverse, pivots first; `above` is that of its parent. Writes the blocks of its columns
/// into Z.
Eigen::MatrixXd MultifrontalCholesky::invertFront(int f, const MatrixXd& above, BlockLower& Z) const {
  const Front& front = fronts_.front[at(f)];
  const Layout& layout = layout_[at(f)];
  const int p = front.p, u = front.u;
  MatrixXd result(p + u, p + u);
  const int* const place = relative_.data() + layout.relative;
  auto rows = result.bottomRightCorner(u, u);
  for (int j = 0; j < u; ++j) {
    for (int i = 0; i < u; ++i) rows(i, j) = above(place[i] / dense::kStripe, place[j] / dense::kStripe);
  }
  slom::invertFront(L_.data() + layout.D, L_.data() + layout.B, p, u, result);
  for (int e = layout.first_entry; e < layout.last_entry; ++e) {
    const Entry& entry = entries_[at(e)];
    Eigen::Map<MatrixXd>(Z.values(entry.block), entry.height, entry.width) =
        result.block(entry.row, entry.column, entry.height, entry.width);
  }
  return result;
}

void MultifrontalCholesky::invertSelected(BlockLower& Z) const {
  std::vector<MatrixXd> inverse(fronts_.front.size());
  std::vector<int> waiting(fronts_.front.size(), 0);  // number of children to come, for fronts below the top
  const auto invert = [&](int t) {
    for (auto f = subtree_[at(t)].rbegin(); f != subtree_[at(t)].rend(); ++f) {
      const Layout& layout = layout_[at(*f)];
      const int parent = fronts_.front[at(*f)].parent;
      const bool has_parent_here = parent >= 0 && subtree_of_[at(parent)] == t;
      MatrixXd own = invertFront(*f, parent >= 0 ? inverse[at(parent)] : MatrixXd(), Z);
      if (has_parent_here && --waiting[at(parent)] == 0 && t + 1 < static_cast<int>(subtree_.size())) {
        inverse[at(parent)].resize(0, 0);
      }
      waiting[at(*f)] = layout.last_child - layout.first_child;
      if (waiting[at(*f)] > 0) inverse[at(*f)] = std::move(own);
    }
  };
  invert(static_cast<int>(subtree_.size()) - 1);
  detail::forEachIndex(static_cast<int>(subtree_.size()) - 1, invert);
}

}  // namespace slom
