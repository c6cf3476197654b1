// expect: slom: argument 2 of the measurement function does not convert to the type of its parameter
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
  const auto residual = [](const mtk::vect<2>& v, const mtk::vect<3>& z) { return v[0] - z[2]; };
#ifdef MUST_FAIL
  est.insertMeasurement(residual, x, mtk::vect<2>());
#else
  est.insertMeasurement(residual, x, mtk::vect<3>());
#endif
}
