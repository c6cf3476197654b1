#include "slom/trajectory/white_noise.hpp"

#include <cmath>
#include <string>

#include "mtk/error.hpp"

namespace slom::trajectory::detail {

namespace {

std::string numberText(double x) { return mtk::detail::classicText("%.9g", x); }

}  // namespace

void checkDuration(double duration) {
  if (std::isfinite(duration) && duration > 0) return;
  throw mtk::Error(
      "slom.bad-duration",
      "the time between two states is " + numberText(duration) + "; pass a positive and finite number",
      "duration");
}

void checkDensity(const double* density, int count) {
  for (int i = 0; i < count; ++i) {
    if (std::isfinite(density[i]) && density[i] > 0) continue;
    throw mtk::Error("slom.bad-density",
                     "the power spectral density of component " + std::to_string(i) + " is " +
                         numberText(density[i]) + "; pass a positive and finite number",
                     "density");
  }
}

}  // namespace slom::trajectory::detail
