// expect: slom: the measurement function of an update must return floating-point numbers; this one returns integers or bool, which round the residual so that it has no derivatives: compute with 1.0 and not 1
#include <slom/filter.hpp>

auto f(slom::UnscentedFilter<mtk::vect<2>>& filter) {
#ifdef MUST_FAIL
  return filter.update([](const auto& x) { return int(x[0]); }, slom::measured(3),
                       slom::StandardDeviation(1));
#else
  return filter.update([](const auto& x) { return x[0]; }, slom::measured(3), slom::StandardDeviation(1));
#endif
}
