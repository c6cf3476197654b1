// expect: slom: slom::vectorized needs a function without captures or members, since one call serves several measurements: pass what it captures as further arguments of insertMeasurement
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x, double scale) {
#ifdef MUST_FAIL
  est.insertMeasurement(slom::vectorized([scale](const auto& v, const auto& z) { return v[0] * scale - z; }),
                        x, 1.0);
#else
  est.insertMeasurement(
      slom::vectorized([](const auto& v, const auto& z, const auto& s) { return v[0] * s - z; }), x, 1.0,
      scale);
#endif
}
