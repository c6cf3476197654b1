// expect: slom: argument 1 of the measurement function does not convert to the type of its parameter
#include <slom/slom.hpp>

double residual(const mtk::vect<2>& x, double z) { return x[0] - z; }

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(residual, 1.0, x);
#else
  est.insertMeasurement(residual, x, 1.0);
#endif
}
