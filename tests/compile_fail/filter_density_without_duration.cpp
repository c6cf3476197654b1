// expect: slom: a prediction with slom::SpectralDensity needs its duration, and any prediction has at most one: pass slom::Duration\(seconds\) among the data, which the motion gets as a number
#include <slom/filter.hpp>

auto f(slom::ErrorStateFilter<mtk::vect<2>>& filter) {
  const auto drive = [](const auto& x, double, double) { return x; };
#ifdef MUST_FAIL
  return filter.predict(drive, slom::SpectralDensity(0.1), 0.1, 3.0);
#else
  return filter.predict(drive, slom::SpectralDensity(0.1), slom::Duration(0.1), 3.0);
#endif
}
