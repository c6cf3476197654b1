// expect: slom: the datum of slom::measured must consist of doubles; this one consists of float, integers or other numbers, which round the residual so that it has no derivatives
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
  const auto same = [](const auto& v) { return v; };
#ifdef MUST_FAIL
  est.insertMeasurement(same, x, slom::measured(mtk::vect<2, float>(1, 2)));
#else
  est.insertMeasurement(same, x, slom::measured(mtk::vect<2>(1, 2)));
#endif
}
