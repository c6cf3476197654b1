/// Columns of J that are nothing but rounding errors. A component that no residual depends on often has them, as in
/// (R - I) t along the axis of R; taken at their word they would send it far away.
#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "slom/linearize/structure.hpp"

namespace slom {

/// Of the largest column of the same variable, whose components may differ in unit, but hardly by this.
inline constexpr double kRoundingColumn = 1e-14;

/// Calls f(block, component) for each such column; `diagonal`: squared lengths of all columns.
template <class F>
void forEachRoundingColumn(const BlockStructure& structure, const Eigen::VectorXd& diagonal, const F& f) {
  for (int b = 0; b < structure.blockCount(); ++b) {
    const int first = structure.offset[static_cast<std::size_t>(b)], dof = structure.dof(b);
    const double largest = dof > 0 ? diagonal.segment(first, dof).maxCoeff() : 0;
    for (int c = 0; c < dof; ++c) {
      if (diagonal[first + c] > 0 && diagonal[first + c] < kRoundingColumn * kRoundingColumn * largest) f(b, c);
    }
  }
}

}  // namespace slom
