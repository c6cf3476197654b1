// Numbers of 19 digits with derivatives by up to 12 unknowns. Only the judge of fits uses them; they share nothing with
// the library.
#pragma once

#include <array>
#include <cmath>

namespace slom::fuzz::fit {

struct Jet {
  static constexpr int kUnknowns = 12;
  long double v = 0;
  std::array<long double, kUnknowns> d{};

  Jet() = default;
  Jet(long double value) : v(value) {}  // NOLINT(google-explicit-constructor): a constant
  static Jet unknown(long double value, int i) {
    Jet x(value);
    x.d[std::size_t(i)] = 1;
    return x;
  }
};

/// Returns f(x, y) for these partial derivatives. Constants stay constant even if a derivative is infinite.
inline Jet chain(long double f, long double fx, const Jet& x, long double fy = 0, const Jet& y = {}) {
  Jet result(f);
  for (std::size_t i = 0; i < result.d.size(); ++i)
    result.d[i] = (x.d[i] == 0 ? 0 : fx * x.d[i]) + (y.d[i] == 0 ? 0 : fy * y.d[i]);
  return result;
}

inline Jet operator+(const Jet& x, const Jet& y) { return chain(x.v + y.v, 1, x, 1, y); }
inline Jet operator-(const Jet& x, const Jet& y) { return chain(x.v - y.v, 1, x, -1, y); }
inline Jet operator-(const Jet& x) { return chain(-x.v, -1, x); }
inline Jet operator*(const Jet& x, const Jet& y) { return chain(x.v * y.v, y.v, x, x.v, y); }
inline Jet operator/(const Jet& x, const Jet& y) { return chain(x.v / y.v, 1 / y.v, x, -x.v / y.v / y.v, y); }
inline Jet sqrt(const Jet& x) { return chain(std::sqrt(x.v), 0.5L / std::sqrt(x.v), x); }
inline Jet exp(const Jet& x) { return chain(std::exp(x.v), std::exp(x.v), x); }
inline Jet sin(const Jet& x) { return chain(std::sin(x.v), std::cos(x.v), x); }
inline Jet cos(const Jet& x) { return chain(std::cos(x.v), -std::sin(x.v), x); }
inline Jet atan2(const Jet& y, const Jet& x) {
  const long double square = x.v * x.v + y.v * y.v;
  return chain(std::atan2(y.v, x.v), x.v / square, y, -y.v / square, x);
}

}  // namespace slom::fuzz::fit
