// expect: mtk: this struct has a member T\[N\], which is not a manifold: use std::array<T, N> or, for numbers, mtk::vect<N>
#include <slom/slom.hpp>

struct Camera {
  double focal;
#ifdef MUST_FAIL
  double distortion[2];
#else
  std::array<double, 2> distortion;
#endif
  mtk::SO3<> orient;
};

void f(slom::Estimator& est) { est.insertRV(Camera{}); }
