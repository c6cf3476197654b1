// expect: slom: a measurement function must return a column vector
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<Eigen::Vector2d> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](const Eigen::Vector2d& v) -> Eigen::RowVector2d { return v.transpose(); }, x);
#else
  est.insertMeasurement([](const Eigen::Vector2d& v) -> Eigen::Vector2d { return v; }, x);
#endif
}
