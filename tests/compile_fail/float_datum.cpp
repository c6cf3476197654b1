// expect: slom: what slom::measured marks must be made of doubles; this datum is made of float, integers or other numbers, which round the residual so that it has no derivatives
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
  const auto same = [](const auto& v) { return v; };
#ifdef MUST_FAIL
  est.insertMeasurement(same, x, slom::measured(mtk::vect<2, float>(1, 2)));
#else
  est.insertMeasurement(same, x, slom::measured(mtk::vect<2>(1, 2)));
#endif
}
