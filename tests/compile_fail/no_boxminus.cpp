// expect: mtk: this type is not a manifold: it lacks `void boxminus
#include <slom/slom.hpp>

struct Angle {
  using scalar = double;
  static constexpr int DOF = 1;
  double a = 0;
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) { a += scale * d[0]; }
#ifndef MUST_FAIL
  void boxminus(mtk::vectview<double, 1> out, const Angle& y) const { out[0] = a - y.a; }
#endif
};

void f(slom::Estimator& est) { est.insertRV(Angle{}); }
