// expect: slom: a parameter of the measurement function is float, an integer or bool, but the variable is a double; rounding its value removes the derivatives: declare the parameter as double or const auto&
#include <slom/slom.hpp>

double doubled(int x) { return 2.0 * x; }
double halved(double x) { return 0.5 * x; }

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(doubled, slom::measured(1.0), x);
#else
  est.insertMeasurement(halved, slom::measured(1.0), x);
#endif
}
