/// Diagonal blocks of the inverse, from the root downwards as far as they change.
///
/// A front's part of the inverse follows from its part of the factor and from its parent's part of the inverse. Let S
/// be what the front gets from its parent. If the factor is unchanged and S has changed by D with -c S <= D <= c S,
/// everything in the subtree of the front changes by at most the fraction c of itself. The reason is that each part
/// depends on S as P + Q S Q^T with constant P >= 0 and Q. So a subtree with a small c stays as it is. With S = L L^T,
/// c = |L^-1 D L^-T|_F is such a bound.
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "online/incremental_cholesky.hpp"
#include "solve/block/front_inverse.hpp"

namespace slom {

using Eigen::MatrixXd;

namespace {
/// Largest cost of testing whether a subtree may stay, as a fraction of the cost of computing it.
constexpr double kTestShare = 0.5;

/// Number of unknowns whose differences are tried.
constexpr Eigen::Index kNearby = 12;

/// Returns whether x^T D x > c x^T S x for the change D of S and some x that are quick to try: unknowns, and
/// differences of two nearby unknowns.
bool doesExceed(const MatrixXd& now, const auto& S, double c) {
  const auto exceeds = [&](double before, double after) { return std::abs(after - before) > c * before; };
  const Eigen::Index u = now.rows();
  for (Eigen::Index i = 0; i < u; ++i) {
    if (exceeds(S(i, i), now(i, i))) return true;
    for (Eigen::Index j = std::max<Eigen::Index>(0, i - kNearby); j < i; ++j) {
      if (exceeds(S(i, i) + S(j, j) - 2 * S(i, j), now(i, i) + now(j, j) - 2 * now(i, j))) return true;
    }
  }
  return false;
}
}  // namespace

void IncrementalCholesky::updateInverse(double most_change) {
  std::vector<int> inverted;
  const auto visit = [&](int f, const MatrixXd& rows) {
    if (mayStay(fronts_[at(f)], rows, most_change)) return;
    invertFront(fronts_[at(f)], rows);
    inverted.push_back(f);
  };
  for (const int f : roots_) visit(f, MatrixXd());
  for (std::size_t i = 0; i < inverted.size(); ++i) {
    const Front& front = fronts_[at(inverted[i])];
    for (const int c : front.children) visit(c, inverseOfRows(fronts_[at(c)], front.inverse_part->Z));
  }
  for (auto f = inverted.rbegin(); f != inverted.rend(); ++f) {
    Inverse& inverse = *fronts_[at(*f)].inverse_part;
    inverse.change_below = 0;
    for (const int c : fronts_[at(*f)].children)
      inverse.change_below = std::max(inverse.change_below, fronts_[at(c)].inverse_part->change);
    inverse.change = inverse.change_below;
    const double n = fronts_[at(*f)].p + fronts_[at(*f)].u;
    inverse.flops = 2 * fronts_[at(*f)].p * n * n;
    for (const int c : fronts_[at(*f)].children) inverse.flops += fronts_[at(c)].inverse_part->flops;
  }
}

/// Returns the part of the parent's Z that belongs to the rows of a front.
MatrixXd IncrementalCholesky::inverseOfRows(const Front& child, const MatrixXd& Z) {
  std::vector<int> rows;
  for (const int column : child.in_parent.columns) rows.push_back(column / dense::kStripe);
  return Z(rows, rows);
}

/// Returns whether the known inverse of the front and its subtree is accurate enough.
bool IncrementalCholesky::mayStay(Front& front, const MatrixXd& rows, double most_change) {
  if (front.inverse_part == nullptr || front.inverse_part->factorization != front.factorization) return false;
  Inverse& inverse = *front.inverse_part;
  const auto before = inverse.Z.bottomRightCorner(front.u, front.u);
  double change = 0;
  if (front.u > 0 && rows != before) {
    if (most_change == 0 || front.children.empty()) return false;
    const double flops_of_test = 2.5 * front.u * front.u * front.u;
    if (flops_of_test > kTestShare * inverse.flops || doesExceed(rows, before, most_change)) return false;
    const Eigen::LLT<MatrixXd> factor(before);
    if (factor.info() != Eigen::Success) return false;
    MatrixXd difference = rows - before;
    factor.matrixL().solveInPlace(difference);
    factor.matrixL().transpose().solveInPlace<Eigen::OnTheRight>(difference);
    change = difference.norm();
  }
  inverse.change = (1 + change) * (1 + inverse.change_below) - 1;
  return inverse.change <= most_change;
}

void IncrementalCholesky::invertFront(Front& front, const MatrixXd& rows) {
  if (front.inverse_part == nullptr) front.inverse_part = std::make_unique<Inverse>();
  Inverse& inverse = *front.inverse_part;
  inverse.Z.resize(front.p + front.u, front.p + front.u);
  inverse.Z.bottomRightCorner(front.u, front.u) = rows;
  slom::invertFront(front.D.data(), front.B.data(), front.p, front.u, inverse.Z);
  inverse.factorization = front.factorization;
  ++work_.fronts_inverted;
}

void IncrementalCholesky::writeInverse(int block, double* out) const {
  const Front& front = fronts_[at(blocks_[at(block)].front)];
  int offset = 0;
  for (auto b = front.pivots.begin(); *b != block; ++b) offset += dof(*b);
  Eigen::Map<MatrixXd>(out, dof(block), dof(block)) =
      front.inverse_part->Z.block(offset, offset, dof(block), dof(block));
}

}  // namespace slom
