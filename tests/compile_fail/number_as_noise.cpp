// expect: slom: an argument after the measurement must be its uncertainty \(Covariance, StandardDeviation, InvCovariance or InvStandardDeviation\), its loss \(Huber, ...\), its label \(slom::named\) or a group \(slom::group\)
#include <slom/slom.hpp>

SLOM_BUILD_MEASUREMENT(Prior, 1, ((double, x)), ((double, z)))
SLOM_IMPLEMENT_MEASUREMENT(Prior, ret) { ret[0] = *x - z; }

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(Prior(x, 1.0), 0.1);
#else
  est.insertMeasurement(Prior(x, 1.0), slom::StandardDeviation(0.1));
#endif
}
