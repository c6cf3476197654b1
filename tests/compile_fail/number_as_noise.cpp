// expect: slom: what follows the measurement says how uncertain it is \(Covariance, StandardDeviation, InvCovariance or InvStandardDeviation\), which loss it has \(Huber, ...\) or how it is called
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
