#include "multifrontal_qr.hpp"

#include <algorithm>
#include <cmath>

#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/threads.hpp"

namespace slom {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

int width(const Fronts& fronts, int position) {
  return fronts.offset[at(position) + 1] - fronts.offset[at(position)];
}

}  // namespace

void MultifrontalQR::analyze(const BlockStructure& structure, Fronts fronts) {
  structure_ = &structure;
  fronts_ = std::move(fronts);
  const std::size_t count = fronts_.front.size();
  unknown_.assign(count, {});
  measurements_.assign(count, {});
  children_.assign(count, {});
  levels_.clear();
  R_.assign(count, {});
  rest_.assign(count, {});
  row_column_.assign(fronts_.row.size(), 0);
  std::vector<int> front_of(fronts_.order.size()), level(count, 0);
  for (std::size_t f = 0; f < count; ++f) {
    const Front& front = fronts_.front[f];
    const auto addUnknowns = [&](int position) {
      const int b = fronts_.order[at(position)];
      for (int i = 0; i < structure.dof(b); ++i) unknown_[f].push_back(structure.offset[at(b)] + i);
    };
    for (int j = front.first_column; j < front.last_column; ++j) {
      front_of[at(j)] = static_cast<int>(f);
      addUnknowns(j);
    }
    for (int k = front.first_row; k < front.last_row; ++k) {
      row_column_[at(k)] = static_cast<int>(unknown_[f].size());
      addUnknowns(fronts_.row[at(k)]);
    }
    if (at(level[f]) >= levels_.size()) levels_.emplace_back();
    levels_[at(level[f])].push_back(static_cast<int>(f));
    if (front.parent < 0) continue;
    children_[at(front.parent)].push_back(static_cast<int>(f));
    level[at(front.parent)] = std::max(level[at(front.parent)], level[f] + 1);
  }
  for (std::size_t g = 0; g < structure.groups.size(); ++g) {
    const MeasurementGroup& group = structure.groups[g];
    for (int m = 0; m < group.size(); ++m) {
      int first = static_cast<int>(fronts_.order.size());
      for (int k = 0; k < group.arity; ++k) {
        const int block = group.blocks[at(m) * at(group.arity) + at(k)];
        if (block >= 0) first = std::min(first, fronts_.position[at(block)]);
      }
      if (at(first) < front_of.size()) measurements_[at(front_of[at(first)])].push_back({g, m});
    }
  }
}

/// Returns the first column of this block in front f.
int MultifrontalQR::columnIn(int f, int position) const {
  const Front& front = fronts_.front[at(f)];
  if (position < front.last_column)
    return fronts_.offset[at(position)] - fronts_.offset[at(front.first_column)];
  const auto first = fronts_.row.begin() + front.first_row, last = fronts_.row.begin() + front.last_row;
  return row_column_[static_cast<std::size_t>(std::lower_bound(first, last, position) - fronts_.row.begin())];
}

/// Rows of a front. Whenever there are many, they are made triangular. So a front that collects thousands of children
/// takes at most a few times its columns squared in memory.
class MultifrontalQR::Panel {
 public:
  /// Reserves room for `rows` rows, in blocks of at most `largest`.
  Panel(Eigen::Index rows, Eigen::Index largest, Eigen::Index columns)
      : A_(MatrixXd::Zero(std::min(rows, std::max(kManyRows * columns, columns + largest)), columns)) {}

  /// Returns the next rows, which are 0.
  auto add(Eigen::Index count) {
    if (next_ + count > A_.rows()) triangularizeWhatThereIs();
    next_ += count;
    return A_.middleRows(next_ - count, count);
  }
  /// Returns the rows; only the upper triangle counts.
  const MatrixXd& finish() {
    if (next_ > 0) triangularize(A_.topRows(next_));
    return A_;
  }
  Eigen::Index rows() const { return next_; }

 private:
  static constexpr Eigen::Index kManyRows = 5;

  void triangularizeWhatThereIs() {
    triangularize(A_.topRows(next_));
    const Eigen::Index kept = std::min(next_, A_.cols());
    A_.bottomRows(A_.rows() - kept).setZero();
    A_.topRows(kept).triangularView<Eigen::StrictlyLower>().setZero();
    next_ = kept;
  }

  MatrixXd A_;
  Eigen::Index next_ = 0;
};

SolveStatus MultifrontalQR::factorizeFront(int f, const JacobianRows& rows, const VectorXd& scale,
                                           const VectorXd& damping, double tolerance) {
  const Front& front = fronts_.front[at(f)];
  const std::vector<int>& unknown = unknown_[at(f)];
  const bool is_damped = damping.size() > 0;
  const int n = front.p + front.u;
  Eigen::Index count = is_damped ? front.p : 0, largest = 1;
  const auto addPart = [&](Eigen::Index part) {
    count += part;
    largest = std::max(largest, part);
  };
  for (const auto& [group, m] : measurements_[at(f)]) addPart(rows.residual(group, m).size());
  for (const int child : children_[at(f)]) addPart(rest_[at(child)].rows());
  Panel panel(count, largest, n + 1);
  for (const auto& [group, m] : measurements_[at(f)]) {
    const auto r = rows.residual(group, m);
    auto A = panel.add(r.size());
    rows.forEachPart(group, m, [&](int block, const JacobianRows::Part& J) {
      const int first = structure_->offset[at(block)];
      A.middleCols(columnIn(f, fronts_.position[at(block)]), J.cols()) +=
          J * scale.segment(first, J.cols()).asDiagonal();
    });
    A.col(n) = -r;
  }
  for (const int child : children_[at(f)]) {
    MatrixXd& rest = rest_[at(child)];
    const Front& from = fronts_.front[at(child)];
    auto A = panel.add(rest.rows());
    for (int k = from.first_row; k < from.last_row; ++k) {
      const int position = fronts_.row[at(k)], columns = width(fronts_, position);
      A.middleCols(columnIn(f, position), columns) = rest.middleCols(row_column_[at(k)] - from.p, columns);
    }
    A.col(n) = rest.col(from.u);
    rest.resize(0, 0);
  }
  for (int j = 0; is_damped && j < front.p; ++j)
    panel.add(1)(0, j) = std::sqrt(damping[unknown[at(j)]]) * scale[unknown[at(j)]];
  const MatrixXd& A = panel.finish();
  const Eigen::Index pivots = std::min<Eigen::Index>(panel.rows(), front.p);
  R_[at(f)] = MatrixXd::Zero(front.p, n + 1);
  R_[at(f)].topRows(pivots) = A.topRows(pivots).triangularView<Eigen::Upper>();
  for (int j = 0; j < front.p; ++j) {
    const double pivot = std::abs(R_[at(f)](j, j));
    if (!(pivot > tolerance)) return {false, unknown[at(j)], pivot * pivot};
  }
  const Eigen::Index left = std::min<Eigen::Index>(panel.rows(), n) - pivots;
  rest_[at(f)] = A.block(pivots, front.p, left, front.u + 1);
  rest_[at(f)].leftCols(front.u) = MatrixXd(rest_[at(f)].leftCols(front.u).triangularView<Eigen::Upper>());
  return {};
}

SolveStatus MultifrontalQR::factorize(const JacobianRows& rows, const VectorXd& scale,
                                      const VectorXd& damping, double tolerance) {
  std::vector<SolveStatus> status(fronts_.front.size());
  for (const std::vector<int>& level : levels_) {
    detail::forEachIndex(static_cast<int>(level.size()), [&](int i) {
      const int f = level[at(i)];
      status[at(f)] = factorizeFront(f, rows, scale, damping, tolerance);
    });
    for (const int f : level) {
      if (!status[at(f)].ok) return status[at(f)];
    }
  }
  return {};
}

VectorXd MultifrontalQR::solve() const {
  VectorXd x = VectorXd::Zero(structure_->unknowns());
  for (int f = static_cast<int>(fronts_.front.size()) - 1; f >= 0; --f) {
    const Front& front = fronts_.front[at(f)];
    const std::vector<int>& unknown = unknown_[at(f)];
    const MatrixXd& R = R_[at(f)];
    VectorXd own = R.col(front.p + front.u);
    for (int j = front.p; j < front.p + front.u; ++j) own -= x[unknown[at(j)]] * R.col(j);
    R.leftCols(front.p).triangularView<Eigen::Upper>().solveInPlace(own);
    for (int j = 0; j < front.p; ++j) x[unknown[at(j)]] = own[j];
  }
  return x;
}

VectorXd MultifrontalQR::solveNormal(const VectorXd& b) const {
  VectorXd x = b;
  const auto gather = [&](int f) {
    VectorXd own(fronts_.front[at(f)].p);
    for (int j = 0; j < own.size(); ++j) own[j] = x[unknown_[at(f)][at(j)]];
    return own;
  };
  const auto scatter = [&](int f, const VectorXd& own) {
    for (int j = 0; j < own.size(); ++j) x[unknown_[at(f)][at(j)]] = own[j];
  };
  const int count = static_cast<int>(fronts_.front.size());
  for (int f = 0; f < count; ++f) {
    const Front& front = fronts_.front[at(f)];
    const MatrixXd& R = R_[at(f)];
    VectorXd own = gather(f);
    R.leftCols(front.p).triangularView<Eigen::Upper>().transpose().solveInPlace(own);
    scatter(f, own);
    for (int j = front.p; j < front.p + front.u; ++j) x[unknown_[at(f)][at(j)]] -= R.col(j).dot(own);
  }
  for (int f = count - 1; f >= 0; --f) {
    const Front& front = fronts_.front[at(f)];
    const MatrixXd& R = R_[at(f)];
    VectorXd own = gather(f);
    for (int j = front.p; j < front.p + front.u; ++j) own -= x[unknown_[at(f)][at(j)]] * R.col(j);
    R.leftCols(front.p).triangularView<Eigen::Upper>().solveInPlace(own);
    scatter(f, own);
  }
  return x;
}

}  // namespace slom
