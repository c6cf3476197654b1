// expect: mtk: arrays T\[N\] and pointers are not manifolds: use std::array<T, N> or, for numbers, mtk::vect<N>
#include <slom/slom.hpp>

void f(slom::Estimator& est) {
  const double start[3] = {1, 2, 3};
#ifdef MUST_FAIL
  est.insertRV(start);
#else
  est.insertRV(mtk::vect<3>(start[0], start[1], start[2]));
#endif
}
