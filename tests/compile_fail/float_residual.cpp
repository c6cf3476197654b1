// expect: slom: a measurement function must return double; this one returns float, an integer or bool, which rounds the residual so that it has no derivatives: compute with double, as in 1.0 and not 1 or 1.f
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](double v, float z) { return static_cast<float>(v) - z; }, x, 1.f);
#else
  est.insertMeasurement([](double v, float z) { return v - z; }, x, 1.f);
#endif
}
