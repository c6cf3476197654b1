#include "analyze/profile.hpp"

#include <cmath>
#include <limits>

namespace slom {

double profileRoot(const std::function<double(double)>& f, double guess, double most) {
  // In s = sqrt(f + 1), which is nearly proportional to t, by the Illinois variant of the false position.
  const auto excess = [&](double t) { return std::sqrt(std::max(0.0, f(t) + 1)) - 1; };
  double low = 0, at_low = -1, high = std::min(guess, most), at_high = excess(high);
  while (!(at_high > 0)) {
    if (high >= most) return most;
    if (high > 500 * guess) return std::numeric_limits<double>::infinity();
    low = high;
    at_low = at_high;
    high = std::min(2 * high, most);
    at_high = excess(high);
  }
  int side = 0;
  for (int i = 0; i < 60 && high - low > 1e-7 * high; ++i) {
    const double t =
        std::isfinite(at_high) ? (low * at_high - high * at_low) / (at_high - at_low) : (low + high) / 2;
    const double at_t = excess(t);
    if (std::abs(at_t) < 1e-8) return t;
    if (at_t > 0) {
      high = t;
      at_high = at_t;
      if (side == 1) at_low /= 2;
      side = 1;
    } else {
      low = t;
      at_low = at_t;
      if (side == -1) at_high /= 2;
      side = -1;
    }
  }
  return (low + high) / 2;
}

}  // namespace slom
