#include "slom/model/loss.hpp"

namespace slom {

namespace {

LossValue tukey(double t, double) {
  if (t >= 1) return {1.0 / 3, 0, 0};
  return {t * (1 - t * (1 - t / 3)), (1 - t) * (1 - t), -2 * (1 - t)};
}

}  // namespace

const LossKind detail::losses::Tukey{"Tukey", "tukey", false, &tukey};

}  // namespace slom
