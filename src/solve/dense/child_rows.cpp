#include "solve/dense/child_rows.hpp"

#include <algorithm>

namespace slom::dense {

void ChildRows::clear() {
  pieces.clear();
  runs.clear();
  columns.clear();
  is_sorted = true;
}

void ChildRows::add(int target, int count, int p) {
  if (!pieces.empty()) {
    Run& last = pieces.back();
    if (target < last.target) is_sorted = false;
    if (target != p && target == last.target + last.length) {
      last.length += count;
      return;
    }
  }
  pieces.push_back({rows(), count, target});
}

void ChildRows::finish(int p) {
  for (const Run& piece : pieces) {
    const int in_panel = piece.target < p ? piece.target : piece.target - p;
    for (int i = 0, length = 0; i < piece.length; i += length) {
      length = std::min(
          {piece.length - i, kStripe - (piece.row + i) % kStripe, kStripe - (in_panel + i) % kStripe});
      runs.push_back({piece.row + i, length, piece.target + i});
    }
    for (int i = 0; i < piece.length; ++i) columns.push_back(kStripe * (piece.target + i));
  }
}

}  // namespace slom::dense
