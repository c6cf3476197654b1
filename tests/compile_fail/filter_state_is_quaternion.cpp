// expect: mtk: Eigen's rotations are not manifolds: use mtk::SO3<>\(q\) for an Eigen::Quaterniond
#include <Eigen/Geometry>

#include <slom/filter.hpp>

auto f() {
#ifdef MUST_FAIL
  slom::ErrorStateFilter filter(Eigen::Quaterniond(1, 0, 0, 0), slom::StandardDeviation(0.1));
#else
  slom::ErrorStateFilter filter(mtk::SO3<>(1, 0, 0, 0), slom::StandardDeviation(0.1));
#endif
  return filter.update([](const auto& x) { return x; }, slom::measured(mtk::SO3<>()),
                       slom::StandardDeviation(0.1));
}
