// expect: slom: a measurement has one loss: pass one of Huber, PseudoHuber, Cauchy, Tukey, GemanMcClure and Barron
#include <slom/slom.hpp>

SLOM_BUILD_MEASUREMENT(Prior, 1, ((double, x)), ((double, z)))
SLOM_IMPLEMENT_MEASUREMENT(Prior, ret) { ret[0] = *x - z; }

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(Prior(x, 1.0), slom::Huber(1), slom::StandardDeviation(0.1), slom::Cauchy(2));
#else
  est.insertMeasurement(Prior(x, 1.0), slom::Huber(1), slom::StandardDeviation(0.1));
#endif
}
