#include <cmath>

#include "slom/model/loss.hpp"

namespace slom {

namespace {

LossValue cauchy(double t, double) {
  const double weight = 1 / (1 + t);
  return {std::log1p(t), weight, -weight * weight};
}

}  // namespace

const LossKind detail::losses::Cauchy{"Cauchy", "cauchy", false, &cauchy};

}  // namespace slom
