// Confidence intervals of one component, and of all.
#include "slom/analyze/intervals.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analyze/fit_tables.hpp"
#include "analyze/profile.hpp"
#include "base/index.hpp"
#include "estimator/analysis_access.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/clustered.hpp"
#include "slom/analyze/profile.hpp"
#include "slom/analyze/student.hpp"

namespace slom {

namespace {

using HalfWidth = std::function<double(int component)>;

/// Returns half the interval in stated standard deviations, as a function of the component, for a quadratic RSS.
/// Computes all components now, because `clustered` is stale once a profile has moved the values.
HalfWidth halfWidth(EstimatorState& own, int variable, double probability, const Clustered* clustered) {
  requireProbabilityOfProfile(probability);
  if (clustered == nullptr) {
    const double quantile = own.sigma == Sigma::estimated
                                ? studentCritical(1 - probability, std::max(1, own.redundancy()))
                                : std::sqrt(chiSquareCritical(1 - probability, 1));
    return [quantile](int) { return quantile; };
  }
  if (&detail::AnalysisAccess::problem(*clustered) != &own.problem) {
    throw Error(
        "slom.stale-clustered",
        "the clustered covariances belong to another estimator; pass slom::clustered(est) of this one",
        "Clustered");
  }
  const Eigen::VectorXd half_widths = detail::AnalysisAccess::halfWidths(*clustered, variable, probability),
                        deviations = detail::deviations(own.covariance(variable, variable));
  return [half_widths, deviations, names = own.problem.componentNames(variable)](int component) {
    if (half_widths[component] > 0) return half_widths[component] / deviations[component];
    throw Error("slom.no-clustered-deviation",
                names[at(component)] +
                    " has no clustered standard deviation, because it is at its bound or all residuals are "
                    "0; "
                    "take the profile without clustered covariances",
                names[at(component)]);
  };
}

ProfileInterval profileOf(EstimatorState& own, int variable, int component, HalfWidth half_width) {
  if (own.isFreeNetwork()) {
    const std::string name = own.problem.componentNames(variable)[at(component)];
    throw Error("slom.free-gauge",
                "the profile of " + name +
                    " has no ends, because the datum of a free network is a choice; fix a datum, or take its "
                    "standard deviation",
                name);
  }
  ProfiledFit fit;
  fit.variance_factor = [&own] { return own.varianceFactor(); };
  fit.is_at_minimum = [&own](double variance_factor) { return own.isAtMinimum(variance_factor); };
  fit.rss = [&own] { return own.rss(); };
  fit.covariance = [&own, variable](double* C) {
    const Eigen::MatrixXd block = own.covariance(variable, variable);
    std::copy(block.data(), block.data() + block.size(), C);
  };
  fit.refit = [&own] { return own.optimize(*own.algorithm, {}).final_rss; };
  fit.half_width = std::move(half_width);
  return profileLikelihood(own.problem, fit, variable, component);
}

ProfileInterval profileAt(const Estimator& est, const VariableHandle& id, const std::string& path,
                          double probability, const Clustered* clustered) {
  EstimatorState& own = stateOf(est);
  const int variable = own.problem.indexOf(id);
  HalfWidth half_width = halfWidth(own, variable, probability, clustered);
  return profileOf(own, variable, profiledComponent(own.problem, variable, path), std::move(half_width));
}

IntervalTable intervalsOf(EstimatorState& own, double probability, const Clustered* clustered) {
  requireProbabilityOfProfile(probability);
  const double factor = own.varianceFactor();
  bool has_rotations = false;
  const std::vector<UnknownRow> unknowns = own.analyze([&](const LinearizedProblem& linearized) {
    return unknownRows(linearized, own.gauge, factor, has_rotations);
  });
  std::vector<HalfWidth> half_width(own.problem.variables().size());
  for (const UnknownRow& unknown : unknowns) {
    HalfWidth& of_variable = half_width[at(unknown.variable)];
    if (!of_variable) of_variable = halfWidth(own, unknown.variable, probability, clustered);
  }
  const bool is_free_network = own.isFreeNetwork();
  IntervalTable table;
  table.probability = probability;
  for (const auto& [variable, component, parameter, is_at_bound] : unknowns) {
    ParameterInterval row{
        .name = parameter.name, .value = parameter.value, .standard_deviation = parameter.standard_deviation};
    row.is_profile = !is_free_network && isCoordinate(own.problem, variable, component);
    if (row.is_profile) {
      const ProfileInterval interval = profileOf(own, variable, component, half_width[at(variable)]);
      row.lower = interval.lower;
      row.upper = interval.upper;
    } else {
      const double half = half_width[at(variable)](component) * parameter.standard_deviation;
      row.lower = row.value - half;
      row.upper = row.value + half;
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

ProfileInterval profile(Estimator& est, const VariableHandle& id, const std::string& path,
                        double probability) {
  return profileAt(est, id, path, probability, nullptr);
}

ProfileInterval profile(Estimator& est, const VariableHandle& id, double probability) {
  return profileAt(est, id, "", probability, nullptr);
}

ProfileInterval profile(Estimator& est, const VariableHandle& id, const std::string& path,
                        const Clustered& clustered, double probability) {
  return profileAt(est, id, path, probability, &clustered);
}

IntervalTable intervals(Estimator& est, double probability) {
  return intervalsOf(stateOf(est), probability, nullptr);
}

IntervalTable intervals(Estimator& est, const Clustered& clustered, double probability) {
  return intervalsOf(stateOf(est), probability, &clustered);
}

}  // namespace slom
