// expect: slom: a history divides predictions, so their noise must grow with the duration: pass slom::SpectralDensity\(q\), slom::noiseArgument<n>\(slom::SpectralDensity\(q\)\), slom::filter::strapdownNoise\(imu, dt\), or slom::grownCovariance\(dt, q\)
#include <slom/filter.hpp>
#include <slom/filter/history.hpp>

auto f(slom::FilterHistory<slom::ErrorStateFilter<mtk::vect<2>>>& history) {
  return history.predict(1, [](auto& filter, double dt) {
    const auto keep = [](const auto& x, double) { return x; };
#ifdef MUST_FAIL
    return filter.predict(keep, slom::Covariance(0.1), dt);
#else
    return filter.predict(keep, slom::SpectralDensity(0.1), slom::Duration(dt));
#endif
  });
}
