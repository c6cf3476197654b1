// expect: slom: argument 1 of the measurement function does not convert to the type of its parameter
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](double& v) { return v -= 1; }, x);
#else
  est.insertMeasurement([](double v) { return v -= 1; }, x);
#endif
}
