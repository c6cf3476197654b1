// Unseen unknowns: their columns of J consist of rounding errors, so no residual depends on them. This file recognises
// them and solves the linear model: undamped steps report them, damped steps leave them where they are.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "linearize/variable_of.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

namespace {
/// Number of times that one step is solved again with more damping of unseen unknowns.
constexpr int kMostHoldings = 10;
/// Relative difference up to which a column of J agrees with the change of the residuals.
constexpr double kAgreement = 1e-2;
/// Diagonal of H, relative to its largest entry, above which all unknowns count as seen: units may differ that much.
constexpr double kHardlySeen = 1e-20;
}  // namespace

/// Returns whether moving the unknown by parts of `step` changes the residuals as its column of J predicts, to 2
/// digits. If the column is rounding errors, so are the changes. They have about that size, but agree only by chance.
bool Evaluator::isTrueColumn(int unknown, double step) {
  const int variable = variableOf(structure_, unknown);
  const int component = unknown - structure_.offsetOf(variable);
  const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(variable)];
  ValueSnapshot before(problem_, {variable});
  const bool was_linearized = linearized_at_ == problem_.valueRevision();
  const auto residuals = [&] {
    std::vector<double> all;
    problem_.forEachUse(variable, [&](MeasurementPool& pool, int i) {
      const std::size_t first = all.size();
      all.resize(first + static_cast<std::size_t>(pool.rows(i)));
      problem_.naming(pool, [&] { pool.evaluate(i, i + 1, all.data() + first); });
    });
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
  };
  const Eigen::VectorXd r = residuals();
  const double length = std::sqrt(solver_->diagonal()[unknown]);
  std::vector<double> d(static_cast<std::size_t>(record.dof), 0.0);
  int agreements = 0;
  for (const double part : {1.0, 0.7e-3, 0.3e-6, 0.9e-8}) {
    d[static_cast<std::size_t>(component)] = part * step;
    record.store->boxplus(record.store->valueAt(record.slot), d.data());
    const double expected = length * std::abs(part * step);
    try {
      const double change = (residuals() - r).norm();
      if (std::abs(change - expected) <= kAgreement * expected) ++agreements;
    } catch (const Error&) {  // the user's function throws there
    }
    before.restore();
  }
  if (was_linearized) linearized_at_ = problem_.valueRevision();
  return agreements >= 2;
}

/// Returns the unknowns that d moves although they are unseen.
std::vector<int> Evaluator::unseenUnknowns(const Eigen::VectorXd& d) {
  std::vector<int> unseen;
  if (!collective_->isAlone()) return unseen;  // a process sees only a part of the residuals
  const Eigen::VectorXd& H = solver_->diagonal();
  if (H.size() == 0 || H.minCoeff() > kHardlySeen * H.maxCoeff()) return unseen;  // the usual case
  const Eigen::VectorXd size = typicalSizes(), effect = H.cwiseSqrt().cwiseProduct(size);
  const double rounding =
      std::numeric_limits<double>::epsilon() * std::max(effect.maxCoeff(), std::sqrt(squared_norm_));
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    const int unknown = static_cast<int>(i);
    if (size[i] > 0 && effect[i] < rounding && !(std::abs(d[i]) <= size[i]) && !isTrueColumn(unknown, d[i]))
      unseen.push_back(unknown);
  }
  return unseen;
}

std::vector<int> Evaluator::unseenAtRest() {
  std::vector<int> unseen;
  const Eigen::VectorXd H = solver_->diagonal(), size = typicalSizes();
  const Eigen::VectorXd effect = H.cwiseSqrt().cwiseProduct(size);
  if (H.size() == 0) return unseen;
  const double rounding =
      std::numeric_limits<double>::epsilon() * std::max(effect.maxCoeff(), std::sqrt(squared_norm_));
  for (int i = 0; i < static_cast<int>(H.size()); ++i) {
    if (H[i] > 0 && size[i] > 0 && effect[i] < rounding && !isTrueColumn(i, 1 / std::sqrt(H[i])))
      unseen.push_back(i);
  }
  return unseen;
}

/// Returns whether residuals do depend on an unseen unknown if its coordinate is some powers of 10 smaller. Then the
/// unknown has left the region of its influence, and the linear model cannot tell the gain of bringing it back. A
/// column of rounding errors stays one everywhere.
bool Evaluator::hasRunAway(int unknown) {
  constexpr int decades = 40;
  const int variable = variableOf(structure_, unknown);
  const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(variable)];
  std::vector<double> x(static_cast<std::size_t>(record.dof));
  record.store->coordinates(record.store->valueAt(record.slot), x.data());
  const double coordinate = x[static_cast<std::size_t>(unknown - structure_.offsetOf(variable))];
  if (!std::isfinite(coordinate)) return false;  // an angle, which returns by itself
  Eigen::VectorXd d = Eigen::VectorXd::Zero(structure_.system.unknowns());
  for (int k = 1; k <= decades; ++k) {
    d[unknown] = coordinate * (std::pow(10.0, -k) - 1);
    const double rss = tryStep(d);
    undo();
    if (!(std::abs(rss - rss_) <= kNoise * rss_)) {
      linearize();
      return true;
    }
  }
  linearize();
  return false;
}

SolveStatus Evaluator::solveUndamped(Eigen::VectorXd& step) {
  bool has_changed = false;
  SolveStatus status = lookAgain(solve({}, step), has_changed);
  if (has_changed) status = solve({}, step);
  full_rank_at_ = ~structured_at_;
  was_hidden_ = false;
  if (!status.ok) return status;
  clearConstrained(step);
  const std::vector<int> unseen = unseenUnknowns(step);
  was_hidden_ = !unseen.empty();
  if (was_hidden_) return {false, unseen.front(), 0, 0};
  full_rank_at_ = structured_at_;
  return status;
}

SolveStatus Evaluator::solveDamped(const Eigen::VectorXd& damping, Eigen::VectorXd& step) {
  SolveStatus status = solve(damping, step);
  Eigen::VectorXd holding;
  for (int i = 0; status.ok && i < kMostHoldings; ++i) {
    clearConstrained(step);
    const std::vector<int> unseen = unseenUnknowns(step);
    if (unseen.empty()) return status;
    if (holding.size() == 0) holding = damping;
    // Each round holds them more firmly, because g may be large even if H is not.
    for (const int u : unseen) holding[u] = std::max(holding[u] * 1e6, solver_->diagonal().maxCoeff());
    status = solve(holding, step);
  }
  if (status.ok) {
    for (const int u : unseenUnknowns(step)) step[u] = 0;
  }
  return status;
}

}  // namespace slom
