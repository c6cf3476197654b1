// expect: slom: a measurement function must predict double; this one returns float, an integer or bool, which rounds the residual so that it has no derivatives: compute with double, as in 1.0 and not 1 or 1.f
#include <slom/slom.hpp>

#ifdef MUST_FAIL
float predicted(double x) { return static_cast<float>(2 * x); }
#else
double predicted(double x) { return 2 * x; }
#endif

void f(slom::Estimator& est, slom::VarID<double> x) {
  est.insertMeasurement(predicted, x, slom::measured(1.0));
}
