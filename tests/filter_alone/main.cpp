// A filter without the compiled library, the heap and the standard streams, as on a microcontroller: 1000 steps of
// inertial navigation, attitude and an unscented filter, with gates and losses, in float. Prints one line and ends with 0 if all is right.
//
// CMakeLists.txt builds it for this machine and, with Debian's cross compiler, for a Cortex-M4, which an emulator runs.
#define EIGEN_NO_MALLOC  // an allocation by Eigen is an assertion
#include <cstdio>
#include <cstdlib>
#include <new>

#include <mtk/detail/sanitizers.hpp>
#include <slom/filter.hpp>
#include <slom/filter/history.hpp>

namespace {

int allocations = 0;

}  // namespace

#if !defined(MTK_ADDRESS_SANITIZER)  // which brings an operator new of its own
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  std::abort();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace {

using Number = float;
using Vec3 = mtk::vect<3, Number>;

/// Flies a circle with exact readings, and corrects by positions. Returns the final error of the position [m].
template <class Filter>
Number fly(Filter& filter, int& refusals) {
  const Number dt = Number(0.01), rate = Number(0.5), speed = 2;
  const Vec3 gyro(0, 0, rate), force(0, rate * speed, Number(9.81));
  for (int k = 1; k <= 500; ++k) {
    const auto step =
        filter.predict(slom::filter::Strapdown(), slom::filter::strapdownNoise({1e-3, 1e-2, 1e-5, 1e-4}, dt),
                       gyro, force, dt);
    refusals += !step;
    if (k % 10 != 0) continue;
    const Number angle = Number(k) * dt * rate, radius = speed / rate;
    const Vec3 position(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0);
    const auto update =
        filter.update(slom::filter::GnssPosition(), position, Vec3(0, 0, 0), slom::StandardDeviation(0.1),
                      slom::Gate(0.9999), slom::Iterations(3), slom::Huber(1.345));
    refusals += !update;
    if (k == 500) return Vec3(filter.state().pose.pos - position).norm();
  }
  return 0;
}

}  // namespace

int main() {
  int refusals = 0;
  slom::filter::StrapdownState<Number> start;
  start.velocity = Vec3(2, 0, 0);
  slom::ErrorStateFilter full(start, slom::StandardDeviation(0.1));
  slom::ErrorStateFilter root(start, slom::StandardDeviation(0.1), slom::square_root);
  const Number e = fly(full, refusals), f = fly(root, refusals);

  slom::filter::AttitudeFilter<Number> attitude;
  for (int k = 0; k < 300; ++k) {
    const auto status =
        attitude.step(Vec3(0, 0, 0), Vec3(0, 0, Number(9.81)), Vec3(0, 15, -40), Number(0.01));
    refusals += status != slom::FilterStatus::done;
  }

  slom::UnscentedFilter unscented(slom::filter::WheelState<Number>(), slom::StandardDeviation(0.1));
  const mtk::vect<2, Number> ahead(1, 0), origin(0, 0);
  for (int k = 0; k < 100; ++k) {
    const Number rate = Number(0.1), dt = Number(0.1);
    refusals +=
        !unscented.predict(slom::filter::WheelOdometry(), slom::StandardDeviation(0.01), ahead, rate, dt);
    refusals += !unscented.update(slom::filter::PlanePosition(), unscented.state().pose.pos, origin,
                                  slom::StandardDeviation(0.1), slom::Cauchy(2.385), slom::Gate(0.9999));
  }

  // Noise of an input, a density, and a measurement that comes 0.3 s late.
  slom::ErrorStateFilter moving(mtk::vect<2, Number>(0, 1), slom::StandardDeviation(0.1));
  const auto move = [](const auto& x, const auto& w, Number h) {
    auto y = x;
    y[0] += x[1] * h;
    y[1] += w[0] * h;
    return y;
  };
  slom::FilterHistory<decltype(moving), 8> history(moving, 0);
  for (int k = 1; k <= 20; ++k) {
    refusals += slom::FilterStatus::done != history.predict(0.1 * k, [=](auto& f, double h) {
      return f.predict(move, slom::noiseArgument<1>(slom::SpectralDensity(0.1)), slom::Duration(Number(h)));
    });
    if (k < 4) continue;
    refusals += slom::FilterStatus::done != history.update(0.1 * k - 0.3, [=](auto& f) {
      return f.update([](const auto& x, Number z) { return x[0] - z; }, Number(0.1 * k - 0.3),
                      slom::StandardDeviation(0.1));
    });
  }

  // Each loss of the library. A measurement that is off by 20 deviations moves the state less than without a loss.
  const auto pulled = [&](const auto&... loss) {
    auto other = unscented;
    const mtk::vect<2, Number> off(other.state().pose.pos[0] + 2, other.state().pose.pos[1]);
    refusals +=
        !other.update(slom::filter::PlanePosition(), off, origin, slom::StandardDeviation(0.1), loss...);
    return other.state().pose.pos[0] - unscented.state().pose.pos[0];
  };
  const Number freely = pulled();
  const bool losses_hold = pulled(slom::Huber(1.345)) < freely && pulled(slom::PseudoHuber(1)) < freely &&
                           pulled(slom::Cauchy(2.385)) < freely && pulled(slom::Tukey(4.685)) < freely &&
                           pulled(slom::GemanMcClure(1)) < freely && pulled(slom::Barron(-2, 1)) < freely;

  const bool good = losses_hold && refusals == 0 && allocations == 0 && e < Number(0.05) &&
                    f < Number(0.05) && attitude.isStarted();
  std::printf("%s: %d refusals, %d allocations, errors below 0.05 m: %d %d, losses hold: %d\n",
              good ? "good" : "bad", refusals, allocations, e < Number(0.05), f < Number(0.05), losses_hold);
  return good ? 0 : 1;
}
