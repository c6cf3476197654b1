// Confidence intervals of one component, and of all.
#include <algorithm>
#include <cmath>
#include <utility>

#include "analyze/fit_tables.hpp"
#include "analyze/profile.hpp"
#include "base/index.hpp"
#include "estimator/state.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/clustered.hpp"
#include "slom/analyze/student.hpp"

namespace slom {

/// Returns half the interval in stated standard deviations, as a function of the component, for a quadratic RSS.
/// Computes all components now, because `clustered` is stale once a profile has moved the values.
Estimator::HalfWidth Estimator::halfWidth(int variable, double probability, const Clustered* clustered) {
  requireProbabilityOfProfile(probability);
  if (clustered == nullptr) {
    const double quantile = state_->sigma == Sigma::estimated
                                ? studentCritical(1 - probability, std::max(1, state_->redundancy()))
                                : std::sqrt(chiSquareCritical(1 - probability, 1));
    return [quantile](int) { return quantile; };
  }
  if (&clustered->problem() != &problem()) {
    throw Error("slom.stale-clustered",
                "the clustered covariances belong to another estimator; pass the result of clustered() of "
                "this one",
                "Clustered");
  }
  const int dof = dofOf(variable);
  Eigen::VectorXd half_widths(dof), deviations(dof);
  clustered->writePerComponent(variable, Clustered::Kind::interval, probability, half_widths.data());
  writeDeviations(variable, deviations.data());
  return [half_widths, deviations, names = problem().componentNames(variable)](int component) {
    if (half_widths[component] > 0) return half_widths[component] / deviations[component];
    throw Error("slom.no-clustered-deviation",
                names[at(component)] +
                    " has no clustered standard deviation, because it is at its bound or all residuals are "
                    "0; "
                    "take the profile without clustered covariances",
                names[at(component)]);
  };
}

ProfileInterval Estimator::profile(int variable, const std::string& path, double probability,
                                   const Clustered* clustered) {
  HalfWidth half_width = halfWidth(variable, probability, clustered);
  return profile(variable, profiledComponent(problem(), variable, path), std::move(half_width));
}

ProfileInterval Estimator::profile(int variable, int component, HalfWidth half_width) {
  if (state_->isFreeNetwork()) {
    const std::string name = problem().componentNames(variable)[at(component)];
    throw Error("slom.free-gauge",
                "the profile of " + name +
                    " has no ends, because the datum of a free network is a choice; fix a datum, or take its "
                    "standard deviation",
                name);
  }
  ProfiledFit fit;
  fit.variance_factor = [this] { return state_->varianceFactor(); };
  fit.is_at_minimum = [this](double variance_factor) { return state_->isAtMinimum(variance_factor); };
  fit.rss = [this] { return getRSS(); };
  fit.covariance = [this, variable](double* C) { writeCovariance(variable, variable, C); };
  fit.refit = [this] { return optimize().final_rss; };
  fit.half_width = std::move(half_width);
  return profileLikelihood(problem(), fit, variable, component);
}

IntervalTable Estimator::intervals(double probability) { return intervals(probability, nullptr); }

IntervalTable Estimator::intervals(const Clustered& clustered, double probability) {
  return intervals(probability, &clustered);
}

IntervalTable Estimator::intervals(double probability, const Clustered* clustered) {
  requireProbabilityOfProfile(probability);
  const double factor = state_->varianceFactor();
  bool has_rotations = false;
  const std::vector<UnknownRow> unknowns = state_->analyze([&](const LinearizedProblem& linearized) {
    return unknownRows(linearized, state_->gauge, factor, has_rotations);
  });
  std::vector<HalfWidth> half_width(problem().variables().size());
  for (const UnknownRow& unknown : unknowns) {
    HalfWidth& own = half_width[at(unknown.variable)];
    if (!own) own = halfWidth(unknown.variable, probability, clustered);
  }
  const bool is_free_network = state_->isFreeNetwork();
  IntervalTable table;
  table.probability = probability;
  for (const auto& [variable, component, parameter, is_at_bound] : unknowns) {
    ParameterInterval row{
        .name = parameter.name, .value = parameter.value, .standard_deviation = parameter.standard_deviation};
    row.is_profile = !is_free_network && isCoordinate(problem(), variable, component);
    if (row.is_profile) {
      const ProfileInterval interval = profile(variable, component, half_width[at(variable)]);
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

}  // namespace slom
