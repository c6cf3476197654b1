// expect: slom: the measurement function does not accept the last argument, which counts as data: write an uncertainty as slom::StandardDeviation\(s\) or slom::Covariance\(c\)
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
  const auto twice = [](const auto& v) { return 2.0 * v; };
#ifdef MUST_FAIL
  est.insertMeasurement(twice, x, slom::measured(1.0), 0.1);
#else
  est.insertMeasurement(twice, x, slom::measured(1.0), slom::StandardDeviation(0.1));
#endif
}
