#include "slom/model/loss.hpp"

namespace slom {

namespace {

LossValue gemanMcClure(double t, double) {
  const double root = 1 / (1 + t);  // square root of the weight
  return {t * root, root * root, -2 * root * root * root};
}

}  // namespace

const LossKind detail::losses::GemanMcClure{"GemanMcClure", "geman-mcclure", false, &gemanMcClure};

}  // namespace slom
