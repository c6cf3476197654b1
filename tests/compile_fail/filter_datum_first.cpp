// expect: slom: the measurement function of an update comes first
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const auto place = [](const auto& x, const mtk::vect<2>& z) { return x - z; };
#ifdef MUST_FAIL
  return filter.update(mtk::vect<2>(1, 2), place, slom::StandardDeviation(0.1));
#else
  return filter.update(place, mtk::vect<2>(1, 2), slom::StandardDeviation(0.1));
#endif
}
