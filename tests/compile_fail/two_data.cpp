// expect: slom: a measurement predicts one datum: mark one argument by slom::measured, and pass the others without it
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](double v) { return v; }, x, slom::measured(1.0), slom::measured(2.0));
#else
  est.insertMeasurement([](double v, double w) { return v * w; }, x, 2.0, slom::measured(1.0));
#endif
}
