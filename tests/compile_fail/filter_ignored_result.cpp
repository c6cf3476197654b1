// expect: a refused update leaves the filter unchanged: look at the result
#include <slom/filter.hpp>

#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wunused-result"
bool f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const auto first = [](const auto& x, double z) { return x[0] - z; };
#ifdef MUST_FAIL
  filter.update(first, 0.1, slom::StandardDeviation(1));
  return true;
#else
  return bool(filter.update(first, 0.1, slom::StandardDeviation(1)));
#endif
}
#pragma GCC diagnostic pop
