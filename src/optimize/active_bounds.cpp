#include "optimize/active_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/index.hpp"

namespace slom {

namespace {

constexpr int kMostActiveSets = 10;  // in one linearisation
constexpr double kAtBound = 1e-14;   // relative; rounding of a step that ends at a bound

/// Calls f(variable, i, bound, x, component) for bound i of each optimised variable; x is its coordinate.
template <class F>
void forEachBound(const Problem& problem, const F& f) {
  const ActiveSet& active = problem.activeSet();
  std::vector<double> x;
  for (const int v : active.constrained()) {
    const VariableRecord& record = problem.variables()[at(v)];
    const std::vector<ComponentBound>& bounds = active.bounds(v);
    if (!active.isOptimized(v) || bounds.empty()) continue;
    x.resize(at(record.dof));
    record.store->coordinates(record.store->valueAt(record.slot), x.data());
    for (std::size_t i = 0; i < bounds.size(); ++i) f(v, i, bounds[i], x[at(bounds[i].component)]);
  }
}

/// Updates `active` from the last linearisation of `linearizer`, whose gradient is g. Returns whether anything changed,
/// so that columns of J change.
bool updateActiveBounds(const Problem& problem, const ProblemStructure& structure,
                        const Linearizer& linearizer, const Eigen::VectorXd& g, ActiveSet& active) {
  bool has_changed = false;
  forEachBound(problem, [&](int v, std::size_t i, const ComponentBound& bound, double x) {
    const bool was_active = active.bounds(v)[i].is_active;
    const double slope = was_active ? linearizer.gradientOfConstrained(v, bound.component)
                                    : g[structure.offsetOf(v) + bound.component];
    const double margin = kAtBound * std::max(std::abs(x), 1e-300);
    const bool is_active =
        (x >= bound.upper - margin && slope < 0) || (x <= bound.lower + margin && slope > 0);
    has_changed = has_changed || is_active != was_active;
    active.activate(v, i, is_active);
  });
  return has_changed;
}

}  // namespace

double linearizeAtBounds(const Problem& problem, const ProblemStructure& structure, Linearizer& linearizer,
                         ActiveSet& active, JacobianSink& sink,
                         const std::function<Eigen::VectorXd()>& gradient) {
  double rss = linearizer.linearize(problem, active, sink);
  for (int i = 0; i < kMostActiveSets && active.hasBounds(); ++i) {
    if (!updateActiveBounds(problem, structure, linearizer, gradient(), active)) break;
    rss = linearizer.linearize(problem, active, sink);
  }
  return rss;
}

Eigen::VectorXd clampedToBounds(const Problem& problem, const ProblemStructure& structure,
                                const Eigen::VectorXd& d) {
  Eigen::VectorXd clamped = d;
  forEachBound(problem, [&](int v, std::size_t, const ComponentBound& bound, double x) {
    const int unknown = structure.offsetOf(v) + bound.component;
    clamped[unknown] = std::clamp(d[unknown], std::min(bound.lower - x, 0.0), std::max(bound.upper - x, 0.0));
  });
  return clamped;
}

void roundToBounds(const Problem& problem) {
  forEachBound(problem, [&](int v, std::size_t, const ComponentBound& bound, double x) {
    const double inside = std::clamp(x, bound.lower, bound.upper);
    if (inside == x) return;
    const VariableRecord& record = problem.variables()[at(v)];
    std::vector<double> d(at(record.dof), 0.0);
    d[at(bound.component)] = inside - x;  // exact, because the two are neighbouring numbers
    record.store->boxplus(record.store->valueAt(record.slot), d.data());
  });
}

}  // namespace slom
