// expect: mtk: Eigen's transforms are not manifolds: use mtk::trafo<mtk::SO3<>>\(mtk::SO3<>\(T.linear\(\)\), T.translation\(\)\) for an Eigen::Isometry3d, and mtk::SO2<> in the plane
#include <Eigen/Geometry>

#include <slom/slom.hpp>

void f(slom::Estimator& est, const Eigen::Isometry3d& T) {
#ifdef MUST_FAIL
  est.insertRV(T);
#else
  est.insertRV(mtk::trafo<mtk::SO3<>>(mtk::SO3<>(T.linear()), T.translation()));
#endif
}
