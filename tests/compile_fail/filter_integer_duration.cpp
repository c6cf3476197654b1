// expect: slom: the last number of a prediction is its duration, and this one is an integer: pass seconds as a floating-point number, or mark the duration by slom::Duration and pass an index before it
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const auto move = [](const auto& x, double) { return x; };
#ifdef MUST_FAIL
  return filter.predict(move, slom::Covariance(0.1), 0);
#else
  return filter.predict(move, slom::Covariance(0.1), slom::Duration(1));
#endif
}
