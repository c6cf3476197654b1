// expect: slom: the measurement function of an update comes first and is called with the state and the data that are passed: mark the datum that it predicts by slom::measured\(z\)
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const auto place = [](const auto& x) { return x; };
#ifdef MUST_FAIL
  return filter.update(place, mtk::vect<2>(1, 2), slom::StandardDeviation(0.1));
#else
  return filter.update(place, slom::measured(mtk::vect<2>(1, 2)), slom::StandardDeviation(0.1));
#endif
}
