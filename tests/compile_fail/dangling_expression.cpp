// expect: slom: the measurement function returns an unevaluated Eigen expression, which may refer to destroyed temporaries; return its value by .eval\(\), or give the function a return type
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<Eigen::Vector2d> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](const auto& v) { return 2 * v.eval(); }, x);
#else
  est.insertMeasurement([](const auto& v) -> Eigen::Vector2d { return 2 * v.eval(); }, x);
#endif
}
