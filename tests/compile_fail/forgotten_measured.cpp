// expect: slom: the measurement function has too few parameters for its data: mark the datum that it predicts by slom::measured\(z\), and write an uncertainty as slom::StandardDeviation\(s\) or slom::Covariance\(c\)
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
  const auto at = [](const auto& v, double t) { return v * t; };
#ifdef MUST_FAIL
  est.insertMeasurement(at, x, 3.0, 1.0, slom::StandardDeviation(0.1));
#else
  est.insertMeasurement(at, x, 3.0, slom::measured(1.0), slom::StandardDeviation(0.1));
#endif
}
