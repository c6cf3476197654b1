// expect: slom: the scalar of an estimated variable must be double
#include <slom/slom.hpp>

void f(slom::Estimator& est) {
#ifdef MUST_FAIL
  est.insertRV(mtk::vect<2, float>(1, 2));
#else
  est.insertRV(mtk::vect<2>(1, 2));
#endif
}
