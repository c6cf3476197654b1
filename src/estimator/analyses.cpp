// Analyses of a fit at its values: what it determines, which measurements do not fit, and what is wrong before the fit.
#include <vector>

#include "analyze/diagnose.hpp"
#include "analyze/preflight.hpp"
#include "analyze/residual_tests.hpp"
#include "estimator/analysis_access.hpp"
#include "slom/analyze/derivative_check.hpp"
#include "slom/analyze/diagnosis.hpp"
#include "slom/analyze/outliers.hpp"
#include "slom/analyze/preflight.hpp"

namespace slom {

Diagnosis diagnose(const Estimator& est) {
  EstimatorState& own = stateOf(est);
  Diagnosis result = own.analyze([](const LinearizedProblem& linearized) { return linearized.diagnosis(); });
  result.unconverged = own.whyUnconverged();
  for (Finding& finding : result.findings)  // a free gauge is intended, so it is no fault
    finding.is_fault =
        finding.is_fault && !(finding.kind == Finding::Kind::gauge && own.gauge != FreeGauge::error);
  if (own.sigma == Sigma::estimated)
    std::erase_if(result.findings,
                  [](const Finding& finding) { return finding.kind == Finding::Kind::implausible_sigma; });
  return result;
}

OutlierReport outliers(const Estimator& est, const OutlierOptions& options) {
  EstimatorState& own = stateOf(est);
  const double factor = own.varianceFactor();
  const int redundancy = own.sigma == Sigma::estimated ? own.redundancy() : 0;
  OutlierReport result = own.analyze([&](const LinearizedProblem& linearized) {
    return checkResiduals(linearized, options, factor, redundancy, own.gauge);
  });
  result.noise = own.noiseOfTests(factor);
  result.unconverged = own.whyUnconverged();
  return result;
}

Preflight preflight(const Estimator& est) {
  return stateOf(est).analyze([](const LinearizedProblem& linearized) { return preflight(linearized); });
}

DerivativeCheck checkDerivatives(const Estimator& est) { return compareDerivatives(stateOf(est).problem); }

}  // namespace slom
