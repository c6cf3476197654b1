// expect: slom: an update takes its noise once: pass slom::StandardDeviation\(s\) or slom::Covariance\(R\)
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const auto first = [](const auto& x, double z) { return x[0] - z; };
#ifdef MUST_FAIL
  return filter.update(first, 0.1);
#else
  return filter.update(first, 0.1, slom::StandardDeviation(1));
#endif
}
