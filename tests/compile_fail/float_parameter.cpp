// expect: slom: a parameter of the measurement function is float, an integer or bool, but the variable is a double; rounding its value removes the derivatives: declare the parameter as double or const auto&
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](float v, int count, double z) { return v * count - z; }, x, 3, 1.0);
#else
  est.insertMeasurement([](double v, int count, double z) { return v * count - z; }, x, 3, 1.0);
#endif
}
