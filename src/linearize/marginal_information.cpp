#include "linearize/marginal_information.hpp"

#include <algorithm>
#include <map>
#include <queue>
#include <unordered_map>

#include "base/decompositions.hpp"
#include "base/index.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Fraction of the original length of a column below which the rest of the column is rounding error.
constexpr double kMarginalRankTolerance = 1e-12;

/// Rows [J r] over some variables.
struct Rows {
  std::vector<int> variables;  // ascending; empty: the rows were eliminated
  MatrixXd A;                  // columns of the variables in order, then r
};

class RowElimination {
 public:
  RowElimination(const Problem& problem, const std::vector<int>& eliminated) : problem_(problem) {
    for (const int v : eliminated) rows_of_[v];
  }

  void add(Rows rows) {
    Index column = 0;
    for (const int v : rows.variables) {
      VectorXd& squares = squares_.try_emplace(v, VectorXd::Zero(dof(v))).first->second;
      squares += rows.A.middleCols(column, dof(v)).colwise().squaredNorm();
      column += dof(v);
    }
    keep(std::move(rows));
  }

  std::vector<InformationFactor> run() {
    using Entry = std::pair<std::size_t, int>;  // number of neighbours, variable
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
    for (const auto& [v, rows] : rows_of_) next.emplace(neighbours(v).size(), v);
    while (!next.empty()) {
      const auto [degree, v] = next.top();
      next.pop();
      const std::vector<int> others = neighbours(v);
      if (others.size() > degree) {  // its degree has grown since it was queued
        next.emplace(others.size(), v);
        continue;
      }
      eliminate(v, others);
    }
    return factors();
  }

 private:
  Index dof(int variable) const { return problem_.variables()[at(variable)].dof; }
  Index columnsOf(const std::vector<int>& variables) const {
    Index sum = 0;
    for (const int v : variables) sum += dof(v);
    return sum;
  }

  void keep(Rows rows) {
    for (const int v : rows.variables) {
      if (const auto found = rows_of_.find(v); found != rows_of_.end()) found->second.push_back(rows_.size());
    }
    rows_.push_back(std::move(rows));
  }

  /// Returns the neighbours of a variable that is not yet eliminated. Forgets its rows that were eliminated.
  std::vector<int> neighbours(int v) {
    std::vector<std::size_t>& own = rows_of_.at(v);
    std::erase_if(own, [&](std::size_t i) { return rows_[i].variables.empty(); });
    std::vector<int> all;
    for (const std::size_t i : own) {
      all.insert(all.end(), rows_[i].variables.begin(), rows_[i].variables.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::erase(all, v);
    return all;
  }

  /// Returns these rows, stacked, over `order` and then r. Many rows are reduced to an upper triangle.
  MatrixXd stacked(const std::vector<std::size_t>& which, const std::vector<int>& order) const {
    std::unordered_map<int, Index> start;
    Index columns = 0;
    for (const int v : order) start[v] = std::exchange(columns, columns + dof(v));
    const Index most = 3 * (columns + 1);
    MatrixXd all = MatrixXd::Zero(most, columns + 1);
    Index height = 0;
    for (const std::size_t i : which) {
      const MatrixXd& A = rows_[i].A;
      for (Index row = 0; row < A.rows(); ++row) {
        if (height == most) height = triangular(all, height);
        Index from = 0;
        for (const int v : rows_[i].variables) {
          all.row(height).segment(start.at(v), dof(v)) = A.row(row).segment(from, dof(v));
          from += dof(v);
        }
        all(height++, columns) = A(row, from);
      }
    }
    height = triangular(all, height);
    return all.topRows(height);
  }

  /// Reduces rows to an upper triangle if there are at least as many rows as columns. Returns the number of rows left;
  /// the others become 0.
  static Index triangular(MatrixXd& all, Index height) {
    const Index n = all.cols();
    if (height < n) return height;
    triangularize(all.topRows(height));
    all.topRows(n).template triangularView<Eigen::StrictlyLower>().setZero();
    all.bottomRows(all.rows() - n).setZero();
    return n;
  }

  /// Returns the inverse of the initial lengths of a variable's columns; 1 for those of length 0.
  VectorXd scaleOf(int v) const {
    return squares_.at(v).unaryExpr([](double s) { return s > 0 ? 1 / std::sqrt(s) : 1; });
  }

  static Index rankOf(const PivotedQR& qr) {
    Index rank = 0;
    while (rank < qr.matrixQR().diagonalSize() &&
           std::abs(qr.matrixQR()(rank, rank)) > kMarginalRankTolerance)
      ++rank;
    return rank;
  }

  void eliminate(int v, const std::vector<int>& others) {
    const std::vector<std::size_t> own = std::move(rows_of_.at(v));
    rows_of_.erase(v);
    if (own.empty()) return;
    std::vector<int> order{v};
    order.insert(order.end(), others.begin(), others.end());
    const MatrixXd all = stacked(own, order);
    for (const std::size_t i : own) rows_[i] = {};
    if (others.empty()) return;
    const Index n = dof(v);
    const PivotedQR qr = pivotedQrOf(all.leftCols(n) * scaleOf(v).asDiagonal());
    const Index rank = rankOf(qr), rest = all.rows() - rank;
    if (rest <= 0) return;
    MatrixXd left = all.rightCols(all.cols() - n);
    left.applyOnTheLeft(qr.householderQ().adjoint());
    MatrixXd A = left.bottomRows(rest);
    const Index height = triangular(A, rest);
    A.conservativeResize(std::min(height, A.cols() - 1), A.cols());  // the last row would be constant
    if (A.rows() > 0) keep({others, std::move(A)});
  }

  /// Returns the remaining rows, grouped by their variables.
  std::vector<InformationFactor> factors() const {
    std::map<std::vector<int>, std::vector<std::size_t>> alike;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!rows_[i].variables.empty()) alike[rows_[i].variables].push_back(i);
    }
    std::vector<InformationFactor> result;
    for (const auto& [variables, which] : alike) {
      const MatrixXd all = stacked(which, variables);
      const Index n = columnsOf(variables);
      VectorXd scale(n);
      Index column = 0;
      for (const int v : variables) {
        scale.segment(column, dof(v)) = scaleOf(v);
        column += dof(v);
      }
      const PivotedQR qr = pivotedQrOf(all.leftCols(n) * scale.asDiagonal());
      const Index rank = rankOf(qr);
      if (rank == 0) continue;
      InformationFactor factor;
      factor.variables = variables;
      MatrixXd R = qr.matrixQR().topRows(rank).template triangularView<Eigen::Upper>();
      R = R * qr.colsPermutation().transpose();
      factor.R = R * scale.cwiseInverse().asDiagonal();
      VectorXd b = all.col(n);
      b.applyOnTheLeft(qr.householderQ().adjoint());
      factor.b = b.head(rank);
      result.push_back(std::move(factor));
    }
    return result;
  }

  const Problem& problem_;
  std::vector<Rows> rows_;
  std::map<int, std::vector<std::size_t>> rows_of_;  // rows of the variables that are still to be eliminated
  std::unordered_map<int, VectorXd> squares_;        // initial squared norms of the columns of each variable
};

/// Returns the rows of a batch of one measurement. If a variable occurs twice, its columns are added. Fixed variables
/// have no columns.
Rows rowsOf(const Problem& problem, const JacobianBatch& batch) {
  const MeasurementPool& pool = *problem.pools()[at(batch.group)];
  const int* const all = pool.variables(batch.first);
  Rows rows;
  for (int k = 0; k < pool.arity(); ++k) {
    if (problem.activeSet().isOptimized(all[k]) && batch.dof[k] > 0) rows.variables.push_back(all[k]);
  }
  std::sort(rows.variables.begin(), rows.variables.end());
  rows.variables.erase(std::unique(rows.variables.begin(), rows.variables.end()), rows.variables.end());
  std::map<int, Index> start;
  Index columns = 0;
  for (const int v : rows.variables) {
    start[v] = std::exchange(columns, columns + problem.variables()[at(v)].dof);
  }
  const int height = batch.rows[0];
  rows.A.setZero(height, columns + 1);
  const double* J = batch.J;
  for (int k = 0; k < pool.arity(); ++k) {
    const int width = batch.dof[k];
    if (const auto found = start.find(all[k]); found != start.end()) {
      rows.A.middleCols(found->second, width) += Eigen::Map<const MatrixXd>(J, height, width);
    }
    J += static_cast<std::ptrdiff_t>(height) * width;
  }
  rows.A.col(columns) = Eigen::Map<const VectorXd>(batch.r, height);
  return rows;
}

}  // namespace

std::vector<MeasurementIndex> measurementsOf(const Problem& problem, const std::vector<int>& variables) {
  std::vector<MeasurementIndex> result;
  for (const int v : variables) {
    problem.forEachUse(v, [&](const MeasurementPool& pool, int i) { result.emplace_back(pool.index(), i); });
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::vector<InformationFactor> marginalInformation(const Problem& problem, Linearizer& linearizer,
                                                   const std::vector<MeasurementIndex>& measurements,
                                                   const std::vector<int>& eliminated) {
  std::vector<int> unknown;
  for (const int v : eliminated) {
    if (problem.activeSet().isOptimized(v)) unknown.push_back(v);
  }
  RowElimination elimination(problem, unknown);
  for (const auto& [pool, i] : measurements) {
    Rows rows = rowsOf(problem, linearizer.linearizeOne(problem, problem.activeSet(), pool, i));
    if (!rows.variables.empty() && rows.A.rows() > 0) elimination.add(std::move(rows));
  }
  return elimination.run();
}

}  // namespace slom
