// expect: slom: a prediction takes its noise once: pass slom::Covariance\(Q\) or slom::StandardDeviation\(s\), slom::SpectralDensity\(q\), or slom::noiseArgument<n>\(noise\)
#include <slom/filter.hpp>

auto f(slom::UnscentedFilter<mtk::vect<2>>& filter) {
  const auto stay = [](const auto& x, double) { return x; };
#ifdef MUST_FAIL
  return filter.predict(stay, 0.1);
#else
  return filter.predict(stay, slom::Covariance(0.1), 0.1);
#endif
}
