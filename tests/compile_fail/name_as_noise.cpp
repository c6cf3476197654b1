// expect: slom: an argument after the measurement must be its uncertainty \(Covariance, StandardDeviation, InvCovariance or InvStandardDeviation\), its loss \(Huber, ...\), its label \(slom::named\) or a group \(slom::group\)
#include <slom/slom.hpp>

SLOM_BUILD_MEASUREMENT(Level, 1, ((double, x)), ((double, z)))
SLOM_IMPLEMENT_MEASUREMENT(Level, ret) { ret[0] = *x - z; }

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(Level(x, 1.0), "level");
#else
  est.insertMeasurement(Level(x, 1.0), slom::named("level"));
#endif
}
