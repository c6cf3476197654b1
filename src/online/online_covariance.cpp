/// Covariances from the factor that an online fit keeps.
#include <algorithm>

#include "base/index.hpp"
#include "online/online_fit.hpp"

namespace slom {

/// Throws unless the factor is that of the present problem. `variable`: the requested one; -1: all.
void OnlineFit::requireCurrent(int variable) const {
  const std::string name = variable < 0 ? "" : problem_.variableName(variable);
  const std::string what =
      variable < 0 ? "no marginals of an update: " : "no covariance of an update for variable " + name + ": ";
  const std::string other = variable < 0 ? "marginals()" : "covariance()";
  if (problem_.activeSet().hasBounds()) {
    throw Error("slom.not-updated", what + "update() leaves problems with bounds to optimize(); ask " + other,
                name);
  }
  if (!is_at_end_ || structure_revision_ != problem_.structureRevision() ||
      value_revision_ != problem_.valueRevision()) {
    throw Error(
        "slom.not-updated",
        what + "the problem has changed since, or optimize() took over; call update() first, or ask " + other,
        name);
  }
}

/// Throws if one of these components is undetermined, so that the variable has no covariance.
void OnlineFit::requireDetermined(int variable, const std::vector<std::pair<int, int>>& undetermined) const {
  for (const auto& [other, component] : undetermined) {
    if (problem_.activeSet().isFixedOrActive(other, component)) continue;
    const std::string name = problem_.componentNames(other)[at(component)];
    throw Error("slom.rank-deficient",
                "variable " + problem_.variableName(variable) +
                    " has no covariance, because no measurement determines " + name +
                    "; add a measurement, or fix " + name,
                problem_.variableName(variable));
  }
}

void OnlineFit::writeCovariance(int a, int b, double* out) const {
  requireCurrent(a);
  const int rows = problem_.variables()[at(a)].dof, columns = problem_.variables()[at(b)].dof;
  std::fill_n(out, at(rows) * at(columns), 0.0);
  if (!hasBlock(a) || !hasBlock(b)) return;
  for (const int v : {a, b}) requireDetermined(v, factor_.undeterminedAbove(v));
  const std::vector<double> block = factor_.inverseBlock(a, b);
  std::copy(block.begin(), block.end(), out);
  problem_.activeSet().clear(a, rows, b, columns, out);
}

void OnlineFit::updateMarginals(double most_change) {
  requireCurrent(-1);
  for (const auto& undetermined : factor_.undetermined())
    requireDetermined(undetermined.first, {undetermined});
  factor_.updateInverse(most_change);
}

void OnlineFit::writeMarginal(int variable, double* out) const {
  factor_.writeInverse(variable, out);
  const int dof = factor_.dof(variable);
  problem_.activeSet().clear(variable, dof, variable, dof, out);
}

}  // namespace slom
