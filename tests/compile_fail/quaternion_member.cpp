// expect: mtk: this type is not a manifold: give it `scalar`, `DOF`, `boxplus` and `boxminus`, or make it a struct without constructors whose members are all manifolds \(mtk::SO3<> in place of Eigen::Quaterniond\)
#include <Eigen/Geometry>

#include <slom/slom.hpp>

struct Camera {
  double focal;
#ifdef MUST_FAIL
  Eigen::Quaterniond orient;
#else
  mtk::SO3<> orient;
#endif
};

void f(slom::Estimator& est) { est.insertRV(Camera{}); }
