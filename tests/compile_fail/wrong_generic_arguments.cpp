// expect: slom: the measurement function does not accept these arguments: it gets `const T&` for each VarID<T> and `const D&` for each datum of type D, in the order of the call
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
  const auto residual = [](const auto& v, double z) { return v[0] - z; };
#ifdef MUST_FAIL
  est.insertMeasurement(residual, x, mtk::vect<2>());
#else
  est.insertMeasurement(residual, x, 1.0);
#endif
}
