// expect: slom: a measurement needs at least one variable: pass the VarID that insertRV returned
#include <slom/slom.hpp>

double residual(double x, double z) { return x - z; }

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(residual, *x, 1.0);
#else
  est.insertMeasurement(residual, x, 1.0);
#endif
}
