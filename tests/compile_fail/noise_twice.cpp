// expect: slom: a measurement has one uncertainty: pass one of Covariance, StandardDeviation, InvCovariance and InvStandardDeviation
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
  const auto level = [](double v) { return v; };
#ifdef MUST_FAIL
  est.insertMeasurement(level, x, slom::StandardDeviation(0.1), slom::Huber(1.345), slom::Covariance(0.01));
#else
  est.insertMeasurement(level, x, slom::StandardDeviation(0.1), slom::Huber(1.345));
#endif
}
