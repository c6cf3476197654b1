// expect: mtk: a member of this compound is not a manifold; its type needs `scalar`, `DOF`, `boxplus` and `boxminus`, or must be a struct without constructors whose members are all manifolds
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

MTK_BUILD_MANIFOLD(Arm, ((Angle, shoulder))((Angle, elbow)))

void f(slom::Estimator& est) { est.insertRV(Arm()); }
