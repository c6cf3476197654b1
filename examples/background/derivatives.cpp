// Derivatives: by differences, and exactly by dual numbers.
#include <algorithm>
#include <cmath>

#include <mtk/dual.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

/// Returns f(x) = exp(x) sin(3 x) / x, for any kind of number.
template <class S>
S f(const S& x) {
  using std::exp;
  using std::sin;
  return exp(x) * sin(3.0 * x) / x;
}

/// Returns the derivative, computed by hand.
double slope(double x) {
  return std::exp(x) * ((std::sin(3 * x) + 3 * std::cos(3 * x)) / x - std::sin(3 * x) / (x * x));
}

volatile double start_at = 1.3;  // volatile, because compilers round constants in different ways
const double kX = start_at;

/// A value and its derivative: (a, a') (b, b') = (a b, a' b + a b').
struct Dual {
  double value, derivative;
};
Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.derivative * b.value + a.value * b.derivative};
}

double forward(double h) { return (f(kX + h) - f(kX)) / h; }
double central(double h) { return (f(kX + h) - f(kX - h)) / (2 * h); }
double relativeError(double derivative) { return std::abs(derivative / slope(kX) - 1); }

/// Returns the power of ten of the error. Rounding errors scatter, so it takes the largest of some nearby steps.
double power(double (*derivative)(double), double exponent) {
  double worst = 1e-17;
  for (int i = 0; i < 15; ++i)
    worst = std::max(worst, relativeError(derivative(std::pow(10.0, exponent + 0.01 * i))));
  return std::log10(worst);
}

void printDerivatives(std::ostream& os) {
  const Dual x{3, 1};  // the unknown itself: its derivative is 1
  const Dual cube = x * x * x;
  os << format("x^3 at 3: %g, derivative %g\n\n", cube.value, cube.derivative);

  mtk::Dual<double, 1> at;
  at.seed(kX, 0);
  const auto exact = f(at);
  os << "relative error of f'(1.3), in powers of ten\n  step     forward  central\n";
  for (const int k : {-2, -4, -6, -8, -10, -12}) {
    os << format("  1e%03d  %8.0f %8.0f\n", k, power(&forward, k), power(&central, k));
  }
  os << format("  dual numbers: below 1e-15: %s\n",
               relativeError(exact.partials().get(0)) < 1e-15 ? "yes" : "no");
}

std::string drawDerivatives() {
  Plot plot(740, 420);
  plot.diagram({80, 20, 640, 340, -14, 0, -17, 1});
  plot.ticks(2, 4, "step of the difference, power of ten", "relative error, power of ten");
  const auto errors = [](double (*derivative)(double)) {
    return graph([=](double k) { return power(derivative, k); }, -14, 0, 57);
  };
  plot.curve(errors(&forward), kRed);
  plot.curve(errors(&central), kBlue);
  plot.curve({{-14, -15.65}, {0, -15.65}}, kGreen, 2, "6 4");
  plot.text({-3, -2.2}, "forward difference", kRed, -40, -10, "end");
  plot.text({-5, -10}, "central difference", kBlue, 14, 4);
  plot.text({-13.8, -15.6}, "dual numbers, and the resolution of a double", kGreen, 0, -8);
  return plot.svg();
}

}  // namespace

const Page kDerivatives{"derivatives", &printDerivatives, &drawDerivatives};
