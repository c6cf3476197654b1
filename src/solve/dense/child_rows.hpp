/// Places of the rows of a child's update in the front of its parent.
#pragma once

#include <vector>

#include "kernels.hpp"

namespace slom::dense {

struct ChildRows {
  std::vector<Run> pieces;   ///< contiguous in both, and on one side of the last pivot
  std::vector<Run> runs;     ///< pieces cut at the stripes of both
  std::vector<int> columns;  ///< kStripe times the parent's row of each
  bool is_sorted = true;     ///< in the order of the parent's rows

  void clear();
  /// Adds the next `count` rows, which begin at `target` of a front with p pivots.
  void add(int target, int count, int p);
  /// Makes runs and columns. Call it after all rows have been added.
  void finish(int p);

  int rows() const { return pieces.empty() ? 0 : pieces.back().row + pieces.back().length; }
  ShuffledChild child(const double* update) const {
    return {{runs.data(), static_cast<int>(runs.size()), columns.data(), rows(), update},
            pieces.data(),
            static_cast<int>(pieces.size())};
  }
};

}  // namespace slom::dense
