// expect: slom: the measurement function has the wrong number of parameters: it gets one argument for each VarID and each datum, none for noise, loss, name and slom::measured
#include <slom/slom.hpp>

double residual(const mtk::vect<2>& x, double z) { return x[0] - z; }

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(residual, x, slom::StandardDeviation(0.1));
#else
  est.insertMeasurement(residual, x, 1.0, slom::StandardDeviation(0.1));
#endif
}
