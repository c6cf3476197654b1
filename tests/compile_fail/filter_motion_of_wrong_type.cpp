// expect: slom: the motion of a prediction must return the new state, of the type of the state
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::trafo<mtk::SO2<>>>& filter) {
#ifdef MUST_FAIL
  return filter.predict([](const auto& x) { return x.pos; }, slom::Covariance(0.1));
#else
  return filter.predict([](const auto& x) { return x; }, slom::Covariance(0.1));
#endif
}
