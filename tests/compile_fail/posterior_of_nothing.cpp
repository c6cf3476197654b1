// expect: slom: pass the variables of the posterior after the estimator
#include <slom/posterior.hpp>

void f(const slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  slom::posterior(est);
  static_cast<void>(x);
#else
  slom::posterior(est, x);
#endif
}
