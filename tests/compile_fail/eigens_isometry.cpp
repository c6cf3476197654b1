// expect: mtk: Eigen's transforms are not manifolds: take mtk::trafo<mtk::SO3<>>\(mtk::SO3<>\(T.linear\(\)\), T.translation\(\)\) for an Eigen::Isometry3d, mtk::SO2<> for one in the plane
#include <Eigen/Geometry>

#include <slom/slom.hpp>

void f(slom::Estimator& est, const Eigen::Isometry3d& T) {
#ifdef MUST_FAIL
  est.insertRV(T);
#else
  est.insertRV(mtk::trafo<mtk::SO3<>>(mtk::SO3<>(T.linear()), T.translation()));
#endif
}
