#include <cmath>

#include "slom/model/loss.hpp"

namespace slom {

namespace {

LossValue huber(double t, double) {
  if (t <= 1) return {t, 1, 0};
  const double root = std::sqrt(t);
  return {2 * root - 1, 1 / root, -0.5 / (t * root)};
}

}  // namespace

const LossKind detail::losses::Huber{"Huber", "huber", false, &huber};

}  // namespace slom
