#include "front_inverse.hpp"

#include <algorithm>
#include <cstddef>

#include "solve/dense/kernels.hpp"

namespace slom {

namespace {

using dense::kStripe;
using Eigen::MatrixXd;

/// Returns the rows x p matrix whose stripes begin at `panel`.
MatrixXd unpack(const double* panel, int rows, int p) {
  MatrixXd result(rows, p);
  for (int s = 0; s < rows; s += kStripe) {
    const int height = std::min(kStripe, rows - s);
    const Eigen::Map<const MatrixXd, 0, Eigen::OuterStride<kStripe>> stripe(
        panel + static_cast<std::ptrdiff_t>(s) * p, height, p);
    result.middleRows(s, height) = stripe;
  }
  return result;
}

}  // namespace

void invertFront(const double* D, const double* B, int p, int u, MatrixXd& Z) {
  const MatrixXd pivots = unpack(D, p, p);
  const MatrixXd inverse = pivots.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(p, p));
  Z.topLeftCorner(p, p).noalias() = inverse.transpose() * inverse;
  if (u == 0) return;
  const MatrixXd Y = unpack(B, u, p) * inverse;
  Z.bottomLeftCorner(u, p).noalias() = -Z.bottomRightCorner(u, u) * Y;
  Z.topLeftCorner(p, p).noalias() -= Y.transpose() * Z.bottomLeftCorner(u, p);
  Z.topRightCorner(p, u) = Z.bottomLeftCorner(u, p).transpose();
}

}  // namespace slom
