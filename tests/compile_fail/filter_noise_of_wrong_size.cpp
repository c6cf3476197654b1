// expect: slom: the matrix of the noise must have one row and one column for each component
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::trafo<mtk::SO2<>>>& filter) {
  const auto place = [](const auto& x) { return x.pos; };
#ifdef MUST_FAIL
  return filter.update(place, slom::measured(mtk::vect<2>(1, 2)),
                       slom::Covariance(Eigen::Matrix3d(Eigen::Matrix3d::Identity())));
#else
  return filter.update(place, slom::measured(mtk::vect<2>(1, 2)),
                       slom::Covariance(Eigen::Matrix2d(Eigen::Matrix2d::Identity())));
#endif
}
