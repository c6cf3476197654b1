// expect: slom: the measurement function has too few parameters for its data: mark the datum that it predicts by slom::measured\(z\), and write an uncertainty as slom::StandardDeviation\(s\) or slom::Covariance\(c\)
#include <slom/slom.hpp>

typedef mtk::trafo<mtk::SO2<>> Pose;
Pose relative(const Pose& a, const Pose& b) { return a.inverse() * b; }

void f(slom::Estimator& est, slom::VarID<Pose> a, slom::VarID<Pose> b) {
#ifdef MUST_FAIL
  est.insertMeasurement(relative, a, b, Pose(), 0.1);
#else
  est.insertMeasurement(relative, a, b, slom::measured(Pose()), slom::StandardDeviation(0.1));
#endif
}
