// expect: slom: a measurement function must return double; this one returns float, an integer or bool, which rounds the residual so that it has no derivatives: compute with double, as in 1.0 and not 1 or 1.f
#include <slom/slom.hpp>

#ifdef MUST_FAIL
int residual(double x) { return x - 1; }
#else
double residual(double x) { return x - 1; }
#endif

void f(slom::Estimator& est, slom::VarID<double> x) { est.insertMeasurement(residual, x); }
