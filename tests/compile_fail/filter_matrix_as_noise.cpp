// expect: slom: a prediction takes its noise once: pass slom::Covariance\(Q\) or slom::StandardDeviation\(s\)
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const Eigen::Matrix2d Q = Eigen::Matrix2d::Identity();
  const auto stay = [](const auto& x) { return x; };
#ifdef MUST_FAIL
  return filter.predict(stay, Q);
#else
  return filter.predict(stay, slom::Covariance(Q));
#endif
}
