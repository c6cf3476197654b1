// expect: slom: the measurement function does not accept these arguments: it gets `const T&` for each VarID<T> and `const D&` for each datum of type D, in the order of the call
#include <slom/slom.hpp>

double residual(const mtk::vect<2>& x, double z) { return x[0] - z; }

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(residual, 1.0, x);
#else
  est.insertMeasurement(residual, x, 1.0);
#endif
}
