// expect: mtk: this type has `scalar` but is not a manifold: it lacks the constant `DOF`
#include <mtk/mtk.hpp>

struct Angle {
  using scalar = double;
#ifndef MUST_FAIL
  static constexpr int DOF = 1;
#endif
  double a = 0;
  Angle(double value = 0) : a(value) {}
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) { a += scale * d[0]; }
  void boxminus(mtk::vectview<double, 1> out, const Angle& y) const { out[0] = a - y.a; }
};

constexpr auto check = [] { mtk::requireManifold<Angle>(); };
