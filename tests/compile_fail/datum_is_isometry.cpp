// expect: mtk: Eigen's transforms are not manifolds: use mtk::trafo<mtk::SO3<>>\(mtk::SO3<>\(T.linear\(\)\), T.translation\(\)\) for an Eigen::Isometry3d, and mtk::SO2<> in the plane
#include <Eigen/Geometry>

#include <slom/slom.hpp>

typedef mtk::trafo<mtk::SO3<>> Pose;

void f(slom::Estimator& est, slom::VarID<Pose> pose, const Eigen::Isometry3d& T) {
  const auto same = [](const Pose& x) { return x; };
#ifdef MUST_FAIL
  est.insertMeasurement(same, pose, slom::measured(T));
#else
  est.insertMeasurement(same, pose, slom::measured(Pose(mtk::SO3<>(T.linear()), T.translation())));
#endif
}
