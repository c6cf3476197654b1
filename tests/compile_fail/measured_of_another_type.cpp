// expect: slom: with slom::measured\(z\) the measurement function must predict a value of the type of z
#include <slom/slom.hpp>

typedef mtk::trafo<mtk::SO2<>> Pose;

void f(slom::Estimator& est, slom::VarID<Pose> a, slom::VarID<Pose> b) {
  const auto relative = [](const Pose& x, const Pose& y) { return x.inverse() * y; };
#ifdef MUST_FAIL
  est.insertMeasurement(relative, a, b, slom::measured(mtk::SO2<>()));
#else
  est.insertMeasurement(relative, a, b, slom::measured(Pose()));
#endif
}
