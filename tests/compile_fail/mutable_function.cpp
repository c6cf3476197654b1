// expect: slom: the measurement function must be const, because several threads call it at once: remove `mutable`, or write `const` after the parameters of operator
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([calls = 0](double v) mutable { return v + 0 * ++calls; }, x);
#else
  est.insertMeasurement([calls = 0](double v) { return v + calls; }, x);
#endif
}
