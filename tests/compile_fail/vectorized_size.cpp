// expect: slom: slom::vectorized needs variables, data and residuals of sizes known at compile time
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x, const Eigen::VectorXd& z) {
#ifdef MUST_FAIL
  est.insertMeasurement(slom::vectorized([](const auto& v, const auto& d) { return v[0] - d[0]; }), x, z);
#else
  est.insertMeasurement(slom::vectorized([](const auto& v, const auto& d) { return v[0] - d[0]; }), x,
                        mtk::vect<2>(z));
#endif
}
