#include <cmath>

#include "slom/model/loss.hpp"

namespace slom {

namespace {

LossValue pseudoHuber(double t, double) {
  const double root = std::sqrt(1 + t);
  return {2 * t / (root + 1), 1 / root, -0.5 / ((1 + t) * root)};
}

}  // namespace

const LossKind detail::losses::PseudoHuber{"PseudoHuber", "pseudo-huber", false, &pseudoHuber};

}  // namespace slom
