// expect: mtk: Eigen's rotations are not manifolds: use mtk::SO3<>\(q\) for an Eigen::Quaterniond or Eigen::AngleAxisd, mtk::SO2<>\(r.angle\(\)\) for an Eigen::Rotation2Dd
#include <Eigen/Geometry>

#include <slom/slom.hpp>

void f(slom::Estimator& est, const Eigen::Quaterniond& q) {
#ifdef MUST_FAIL
  est.insertRV(q);
#else
  est.insertRV(mtk::SO3<>(q));
#endif
}
