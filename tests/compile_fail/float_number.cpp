// expect: slom: the scalar of an estimated variable must be double
#include <slom/slom.hpp>

void f(slom::Estimator& est) {
#ifdef MUST_FAIL
  est.insertRV(1.5f);
#else
  est.insertRV(1.5);
#endif
}
