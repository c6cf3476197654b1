// expect: slom: posterior takes the variables that it is about after the estimator
#include <slom/posterior.hpp>

void f(const slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  slom::posterior(est);
  static_cast<void>(x);
#else
  slom::posterior(est, x);
#endif
}
