#include "analyze/variance/variance_model.hpp"

#include <algorithm>
#include <cmath>

#include "analyze/free_network.hpp"
#include "base/index.hpp"
#include "base/threads.hpp"
#include "slom/solve/block_qr.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeverageAccuracy = 1e-6;  // relative to the sum of all leverages, the number of unknowns
constexpr int kRowsPerTask = 256;

}  // namespace

VarianceModel::VarianceModel(const LinearizedProblem& linearized, FreeGauge gauge,
                             std::vector<std::vector<int>> component_of, std::vector<SharedTerm> shared,
                             int kinds)
    : linearized_(linearized),
      gauge_(gauge),
      component_of_(std::move(component_of)),
      shared_(std::move(shared)),
      kinds_(kinds),
      original_groups_(linearized.structure().system.groups.size()) {
  static_cast<void>(linearized.covarianceTimes(gauge, MatrixXd(linearized.structure().system.unknowns(), 0)));
  makeStructure();
  rows_.analyze(structure_);
  addRows();
  addDatum();
  theta_ = VectorXd::Ones(components());
  residuals_ = VectorXd::Zero(components());
  for (std::size_t g = 0; g < structure_.groups.size(); ++g) {
    for (int m = 0; m < rows_.size(g); ++m) {
      if (const int c = componentOf(g, m); c >= 0)
        residuals_[c] += static_cast<double>(rows_.residual(g, m).size());
    }
  }
  solver_ = std::make_unique<BlockSolver>(BlockSolverOptions{.method = BlockSolverOptions::Method::cholesky});
  solver_->analyze(structure_);
}

/// Makes the structure. Blocks: those of the problem, and one for each group of each shared error. Groups of rows:
/// those of the problem, those of the shared errors themselves, and the datum.
void VarianceModel::makeStructure() {
  structure_ = linearized_.structure().system;
  for (const SharedTerm& term : shared_) {
    const int first = structure_.blockCount();
    for (int g = 0; g < term.groups.count(); ++g)
      structure_.offset.push_back(structure_.offset.back() + term.dimension);
    for (std::size_t p = 0; p < term.groups.of_pool.size(); ++p) {
      const std::vector<int>& of = term.groups.of_pool[p];
      if (std::all_of(of.begin(), of.end(), [](int g) { return g < 0; })) continue;
      MeasurementGroup& group = structure_.groups[p];
      MeasurementGroup longer{group.arity + 1, {}};
      for (std::size_t i = 0; i < of.size(); ++i) {
        const auto own = group.blocks.begin() + static_cast<std::ptrdiff_t>(i * at(group.arity));
        longer.blocks.insert(longer.blocks.end(), own, own + group.arity);
        longer.blocks.push_back(of[i] < 0 ? -1 : first + of[i]);
      }
      group = std::move(longer);
    }
    const bool is_chain = !term.previous.empty();
    MeasurementGroup own{is_chain ? 2 : 1, {}};
    for (int g = 0; g < term.groups.count(); ++g) {
      own.blocks.push_back(first + g);
      if (is_chain) own.blocks.push_back(term.previous[at(g)] < 0 ? -1 : first + term.previous[at(g)]);
    }
    structure_.groups.push_back(std::move(own));
  }
  MeasurementGroup datum{1, {}};
  for (int b = 0; gauge_ == FreeGauge::inner_constraints && b < linearized_.structure().system.blockCount();
       ++b) {
    if (!structure_.isEmpty(b)) datum.blocks.push_back(b);
  }
  structure_.groups.push_back(std::move(datum));
}

/// Adds the rows of the problem, each with an identity for its shared errors, and the rows 0 = b.
void VarianceModel::addRows() {
  const JacobianRows& from = linearized_.rows();
  const std::vector<MeasurementGroup>& before = linearized_.structure().system.groups;
  std::vector<int> dof;
  std::vector<double> J;
  for (std::size_t g = 0; g < original_groups_; ++g) {
    const MeasurementGroup& shape = structure_.groups[g];
    for (int m = 0; m < from.size(g); ++m) {
      const auto r = from.residual(g, m);
      dof.assign(at(shape.arity), 0);
      J.clear();
      int k = 0;
      const auto skip_fixed = [&] {
        while (k < before[g].arity && shape.blocks[at(m * shape.arity + k)] < 0) ++k;
      };
      from.forEachPart(g, m, [&](int, const JacobianRows::Part& part) {
        skip_fixed();
        dof[at(k++)] = static_cast<int>(part.cols());
        J.insert(J.end(), part.data(), part.data() + part.size());
      });
      for (k = before[g].arity; k < shape.arity; ++k) {
        if (shape.blocks[at(m * shape.arity + k)] < 0) continue;
        dof[at(k)] = static_cast<int>(r.size());
        const MatrixXd unit = MatrixXd::Identity(r.size(), r.size());
        J.insert(J.end(), unit.data(), unit.data() + unit.size());
      }
      const int rows = static_cast<int>(r.size());
      rows_.add({static_cast<int>(g), m, 1, &rows, dof.data(), r.data(), J.data()});
    }
  }
  addSharedRows();
}

/// Adds 0 = b or, along a chain, 0 = (b - a b') / sqrt(1 - a^2). b' belongs to the previous place, and a =
/// exp(-distance).
void VarianceModel::addSharedRows() {
  for (std::size_t s = 0; s < shared_.size(); ++s) {
    const SharedTerm& term = shared_[s];
    const int rows = term.dimension;
    const VectorXd none = VectorXd::Zero(rows);
    for (int g = 0; g < term.groups.count(); ++g) {
      const bool has_previous = !term.previous.empty() && term.previous[at(g)] >= 0;
      const int dof[] = {rows, has_previous ? rows : 0};
      MatrixXd J = MatrixXd::Identity(rows, has_previous ? 2 * rows : rows);
      if (has_previous) {
        const double t = term.distance[at(g)], scale = 1 / std::sqrt(-std::expm1(-2 * t));
        J.leftCols(rows) *= scale;
        J.rightCols(rows) = -std::exp(-t) * scale * MatrixXd::Identity(rows, rows);
      }
      rows_.add({static_cast<int>(original_groups_ + s), g, 1, &rows, dof, none.data(), J.data()});
    }
  }
}

/// Adds rows that fix a free gauge. They change no residual and so no leverage.
void VarianceModel::addDatum() {
  if (gauge_ != FreeGauge::inner_constraints) return;
  const VectorXd damping = FreeNetwork(linearized_).damping();
  const std::size_t g = structure_.groups.size() - 1;
  int m = 0;
  for (const int b : structure_.groups[g].blocks) {
    const int dof = structure_.dof(b);
    const MatrixXd J = damping.segment(structure_.offset[at(b)], dof).cwiseSqrt().asDiagonal();
    const VectorXd none = VectorXd::Zero(dof);
    rows_.add({static_cast<int>(g), m++, 1, &dof, &dof, none.data(), J.data()});
  }
}

int VarianceModel::componentOf(std::size_t group, int m) const {
  if (group < component_of_.size()) return component_of_[group][at(m)];
  if (group < original_groups_ || group + 1 == structure_.groups.size()) return -1;
  return kinds_ + static_cast<int>(group - original_groups_);
}

void VarianceModel::weigh(const VectorXd& theta) {
  const VectorXd by = (theta_.array() / theta.array()).sqrt();
  for (std::size_t g = 0; g < structure_.groups.size(); ++g) {
    for (int m = 0; m < rows_.size(g); ++m) {
      if (const int c = componentOf(g, m); c >= 0 && by[c] != 1) rows_.multiply(g, m, by[c]);
    }
  }
  theta_ = theta;
}

bool VarianceModel::solve() {
  rows_.sendTo(*solver_);
  MatrixXd X;
  const SolveStatus solved = solver_->solveFor(-rows_.gradient(), X);
  if (!solved.ok || !solver_->invertBlocks(structure_, inverse_).ok) return false;
  step_ = X.col(0);
  return true;
}

/// Adds squares of residuals, and redundancies. Returns the sum of all leverages.
double VarianceModel::addLeverages(Evaluation& result) const {
  const int n = components();
  result.square = VectorXd::Zero(n);
  result.redundancy = residuals_;
  double sum = 0;
  for (std::size_t g = 0; g < structure_.groups.size(); ++g) {
    const int tasks = (rows_.size(g) + kRowsPerTask - 1) / kRowsPerTask;
    std::vector<VectorXd> squares(at(tasks), VectorXd::Zero(n)), leverages = squares;
    std::vector<double> others(at(tasks), 0);
    detail::forEachIndex(tasks, [&](int t) {
      MatrixXd C;
      const int last = std::min(rows_.size(g), (t + 1) * kRowsPerTask);
      for (int m = t * kRowsPerTask; m < last; ++m) {
        VectorXd v = rows_.residual(g, m);
        double leverage = 0;
        rows_.forEachPart(g, m, [&](int a, const JacobianRows::Part& Ja) {
          v += Ja * step_.segment(structure_.offset[at(a)], Ja.cols());
          rows_.forEachPart(g, m, [&](int b, const JacobianRows::Part& Jb) {
            C.resize(Ja.cols(), Jb.cols());
            inverse_->block(a, b, C.data());
            leverage += (Ja * C).cwiseProduct(Jb).sum();
          });
        });
        const int c = componentOf(g, m);
        (c < 0 ? others[at(t)] : leverages[at(t)][c]) += leverage;
        if (c >= 0) squares[at(t)][c] += v.squaredNorm();
      }
    });
    for (std::size_t t = 0; t < at(tasks); ++t) {
      result.square += squares[t];
      result.redundancy -= leverages[t];
      sum += leverages[t].sum() + others[t];
    }
  }
  return sum;
}

VarianceModel::Evaluation VarianceModel::evaluate(const VectorXd& theta, bool is_rough) {
  weigh(theta);
  Evaluation result;
  const double unknowns = structure_.unknowns();
  const auto is_accurate = [&] {
    return std::abs(addLeverages(result) - unknowns) <= kLeverageAccuracy * std::max(1.0, unknowns);
  };
  bool is_solved = solve();
  is_accurate_ = is_solved && is_accurate();
  if (!is_accurate_) {  // J^T J has lost too many digits
    solver_ = std::make_unique<BlockQR>();
    solver_->analyze(structure_);
    is_solved = solve();
    if (!is_solved) throw linearized_.undetermined(SolveStatus{false, 0, 0, 0});
    is_accurate_ = is_accurate();
  }
  addInformation(result, is_rough);
  return result;
}

/// Returns the mean, over b given the data, of the derivative of the log-density of b by the logarithm of the length.
/// Let u = b - a b', w = 1 - a^2 and a' = a t, with t the distance over the length and d the dimension of b. Each place
/// with a previous one contributes d a a' / w + a' u b' / (theta w) - a a' |u|^2 / (theta w^2).
double VarianceModel::lengthSlope(int s) const {
  const SharedTerm& term = shared_[at(s)];
  const MeasurementGroup& own = structure_.groups[original_groups_ + at(s)];
  const double theta = theta_[kinds_ + s];
  const int d = term.dimension;
  MatrixXd C11(d, d), C10(d, d), C00(d, d);
  double sum = 0;
  for (int g = 0; g < term.groups.count(); ++g) {
    if (term.previous.empty() || term.previous[at(g)] < 0) continue;
    const int one = own.blocks[at(2 * g)], before = own.blocks[at(2 * g + 1)];
    inverse_->block(one, one, C11.data());
    inverse_->block(one, before, C10.data());
    inverse_->block(before, before, C00.data());
    const double t = term.distance[at(g)], a = std::exp(-t), w = -std::expm1(-2 * t), change = a * t;
    const VectorXd b = step_.segment(structure_.offset[at(one)], d),
                   b0 = step_.segment(structure_.offset[at(before)], d), u = b - a * b0;
    const double uu = u.squaredNorm() + (C11 - 2 * a * C10 + a * a * C00).trace(),
                 ub = u.dot(b0) + (C10 - a * C00).trace();
    sum += change * (d * a / w + ub / (theta * w) - a * uu / (theta * w * w));
  }
  return sum;
}

double VarianceModel::largestMove() const {
  double largest = 0;
  MatrixXd C;
  for (int b = 0; b < linearized_.structure().system.blockCount(); ++b) {
    const int dof = structure_.dof(b);
    C.resize(dof, dof);
    if (dof > 0) inverse_->block(b, b, C.data());
    for (int i = 0; i < dof; ++i) {
      if (linearized_.activeSet().isFixedOrActive(b, i) || !(C(i, i) > 0)) continue;
      largest = std::max(largest, std::abs(step_[structure_.offset[at(b)] + i]) / std::sqrt(C(i, i)));
    }
  }
  return largest;
}

}  // namespace slom
