#include "slom/optimize/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "linearize/stopwatch.hpp"

namespace slom {

namespace {
constexpr int kMostActiveSets = 10;  // in one linearisation
constexpr double kHardlySeen = 1e-20;  // diagonal of H, relative to the largest: units may differ that much
constexpr double kAtBound = 1e-14;   // relative: rounding errors of a step that ends at a bound

/// Whether the largest of some products of squares is right: none of those that matter has left the range of numbers.
bool isWellScaled(double largest) { return largest > 1e-200 && largest < 1e200; }
}  // namespace

void System::setSolver(LinearSolver& solver) {
  solver_ = &solver;
  analyzed_at_ = linearized_at_ = ~std::uint64_t{0};
}

const ProblemStructure& System::structure() {
  if (structured_at_ != problem_.structureRevision()) {
    const detail::Stopwatch watch(setup_seconds_);
    structure_ = makeStructure(problem_);
    structured_at_ = problem_.structureRevision();
    linearized_at_ = ~std::uint64_t{0};
  }
  return structure_;
}

double System::linearize() {
  structure();
  if (linearized_at_ == problem_.valueRevision() && analyzed_at_ == structured_at_) return rss_;
  if (analyzed_at_ != structured_at_) {
    const detail::Stopwatch watch(setup_seconds_);
    solver_->analyze(structure_.system);
    analyzed_at_ = structured_at_;
  }
  const detail::Stopwatch watch(linearize_seconds_);
  linearized_at_ = ~std::uint64_t{0};
  rss_ = linearizer_.linearize(problem_, *solver_);
  for (int i = 0; i < kMostActiveSets && problem_.hasBounds() && updateActiveBounds(); ++i) {
    rss_ = linearizer_.linearize(problem_, *solver_);
  }
  squared_norm_ = linearizer_.squaredNormSent();
  linearized_at_ = problem_.valueRevision();
  return rss_;
}

template <class F>
void System::forEachBound(const F& f) {
  std::vector<double> x;
  for (const int v : problem_.constrained()) {
    const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(v)];
    if (!record.optimize || record.bounds.empty()) continue;
    x.resize(static_cast<std::size_t>(record.dof));
    record.store->coordinates(record.store->valueAt(record.slot), x.data());
    for (std::size_t b = 0; b < record.bounds.size(); ++b) {
      const int component = record.bounds[b].component;
      f(v, problem_.bound(v, b), x[static_cast<std::size_t>(component)],
        structure_.offset_of_variable[static_cast<std::size_t>(v)] + component);
    }
  }
}

/// Holds what is at a limit beyond which the RSS falls, and lets go of the rest. Returns whether anything changed.
bool System::updateActiveBounds() {
  bool has_changed = false;
  forEachBound([&](int variable, ComponentBound& bound, double x, int unknown) {
    const double g = bound.is_active ? linearizer_.gradientOfHeld(variable, bound.component) : solver_->gradient()[unknown];
    const double margin = kAtBound * std::max(std::abs(x), 1e-300);
    const bool holds = (x >= bound.upper - margin && g < 0) || (x <= bound.lower + margin && g > 0);
    has_changed = has_changed || holds != bound.is_active;
    bound.is_active = holds;
  });
  return has_changed;
}

/// The step up to the bounds.
Eigen::VectorXd System::withinBounds(const Eigen::VectorXd& d) {
  Eigen::VectorXd clamped = d;
  forEachBound([&](int, const ComponentBound& bound, double x, int unknown) {
    clamped[unknown] = std::clamp(d[unknown], std::min(bound.lower - x, 0.0), std::max(bound.upper - x, 0.0));
  });
  return clamped;
}

void System::move(const Eigen::VectorXd& d) {
  problem_.save();
  if (problem_.hasBounds()) {
    problem_.applyStep(structure_.offset_of_variable, withinBounds(d).data());
  } else {
    problem_.applyStep(structure_.offset_of_variable, d.data());
  }
}

double System::tryStep(const Eigen::VectorXd& d) {
  const detail::Stopwatch watch(linearize_seconds_);
  saved_is_linearized_ = linearized_at_ == problem_.valueRevision();
  move(d);
  try {
    return linearizer_.rss(problem_);
  } catch (...) {
    undo();
    throw;
  }
}

double System::tryLikelyStep(const Eigen::VectorXd& d) {
  const auto& pools = problem_.pools();
  const auto is_numeric = [](const auto& pool) { return pool->derivatives() == DerivativeSource::numeric; };
  if (std::any_of(pools.begin(), pools.end(), is_numeric)) return tryStep(d);
  saved_is_linearized_ = false;
  move(d);
  try {
    return linearize();
  } catch (const Error&) {  // something is not finite there, or threw: found out in the usual way
    undo();
    return tryStep(d);
  } catch (...) {
    undo();
    throw;
  }
}

bool System::cameCloser(const Eigen::VectorXd& damping, double promised) {
  saved_is_linearized_ = false;
  try {
    linearize();
  } catch (...) {
    undo();
    throw;
  }
  Eigen::VectorXd next;
  return solver_->solve(damping, next).ok && predictedDecrease(next, damping) < promised;
}

void System::undo() {
  problem_.restore();
  linearized_at_ = saved_is_linearized_ ? problem_.valueRevision() : ~std::uint64_t{0};
}

void System::setLossWidening(double widening) {
  linearizer_.setLossWidening(widening);
  linearized_at_ = ~std::uint64_t{0};
}

double System::gradientCosine() const {
  const double r = std::sqrt(squared_norm_);
  const auto g = solver_->gradient().array();
  const auto h = solver_->diagonal().array();
  if (g.size() == 0 || !(r > 0)) return 0;
  const double squared = (h > 0).select(g.square() / h, 0.0).maxCoeff();
  if (isWellScaled(squared)) return std::sqrt(squared) / r;
  return (h > 0).select(g.abs() / h.sqrt(), 0.0).maxCoeff() / r;
}

double System::stepInDeviations(const Eigen::VectorXd& d) const {
  const auto h = solver_->diagonal().array();
  if (d.size() == 0) return 0;
  const double squared = (d.array().square() * h).maxCoeff();
  return isWellScaled(squared) ? std::sqrt(squared) : (d.array().abs() * h.sqrt()).maxCoeff();
}

Eigen::VectorXd System::magnitudes() {
  Eigen::VectorXd magnitude(structure_.system.unknowns());
  const auto& table = problem_.variables();
  for (std::size_t b = 0; b < structure_.variable_of_block.size(); ++b) {
    const VariableRecord& record = table[static_cast<std::size_t>(structure_.variable_of_block[b])];
    record.store->magnitudes(record.slot, magnitude.data() + structure_.system.offset[b]);
  }
  return magnitude;
}

/// The unknown that d moves though it is not seen, -1 without one.
int System::unseenUnknown(const Eigen::VectorXd& d) {
  const Eigen::VectorXd& H = solver_->diagonal();
  if (H.size() == 0 || H.minCoeff() > kHardlySeen * H.maxCoeff()) return -1;  // as nearly always
  const Eigen::VectorXd magnitude = magnitudes(), effect = H.cwiseSqrt().cwiseProduct(magnitude);
  const double rounding = std::numeric_limits<double>::epsilon() * effect.maxCoeff();
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    if (magnitude[i] > 0 && effect[i] < rounding && std::abs(d[i]) > magnitude[i]) return static_cast<int>(i);
  }
  return -1;
}

SolveStatus System::solveUndamped(Eigen::VectorXd& step) {
  const SolveStatus status = solver_->solve({}, step);
  const int unseen = status.ok ? unseenUnknown(step) : -1;
  return unseen < 0 ? status : SolveStatus{false, unseen, 0};
}

SolveStatus System::solveDamped(const Eigen::VectorXd& damping, Eigen::VectorXd& step) {
  SolveStatus status = solver_->solve(damping, step);
  int unseen = status.ok ? unseenUnknown(step) : -1;
  if (unseen < 0) return status;
  Eigen::VectorXd holding = damping;
  for (; unseen >= 0; unseen = status.ok ? unseenUnknown(step) : -1) {
    holding[unseen] = solver_->diagonal().maxCoeff();
    status = solver_->solve(holding, step);
  }
  return status;
}

bool System::isNegligible(const Eigen::VectorXd& d, double tolerance) {
  std::vector<double> magnitude;
  const auto& variable = structure_.variable_of_block;
  for (std::size_t b = 0; b < variable.size(); ++b) {  // seldom beyond the first
    const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(variable[b])];
    magnitude.resize(static_cast<std::size_t>(record.dof));
    record.store->magnitudes(record.slot, magnitude.data());
    for (int c = 0; c < record.dof; ++c) {
      const int i = structure_.system.offset[b] + c;
      const double column = std::sqrt(solver_->diagonal()[i]);
      const double limit = tolerance * (magnitude[static_cast<std::size_t>(c)] + (column > 0 ? 1 / column : 0));
      if (!(std::abs(d[i]) <= limit)) return false;
    }
  }
  return true;
}

double System::predictedDecrease(const Eigen::VectorXd& d) const {
  return -(2 * solver_->gradient().dot(d) + solver_->squaredImage(d));
}

double System::predictedDecrease(const Eigen::VectorXd& d, const Eigen::VectorXd& damping) const {
  if (!solver_->isExact()) return predictedDecrease(d);
  const double damped = damping.size() > 0 ? damping.dot(d.cwiseAbs2()) : 0;
  return damped - solver_->gradient().dot(d);
}

PhaseSeconds System::seconds() const {
  return {setup_seconds_, linearize_seconds_, solver_->seconds().factorize, solver_->seconds().solve};
}

}  // namespace slom
