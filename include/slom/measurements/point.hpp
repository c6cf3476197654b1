/// What the measurement kinds take as a point or a number.
#pragma once

#include "mtk/types/scalar.hpp"
#include "mtk/types/vect.hpp"

namespace slom::detail {

/// A point is a vector or the position of a pose.
const auto& positionOf(const auto& x) {
  if constexpr (requires { x.pos; }) {
    return x.pos;
  } else {
    return x;
  }
}

/// |v|. At v = 0, where all directions are equal, the derivative is that along the first axis, so that a fit which starts there leaves
/// it.
auto lengthOf(const auto& v) {
  using mtk::select;
  using std::sqrt;
  const auto square = v.squaredNorm();
  using S = std::decay_t<decltype(square)>;
  return select(square > S(0), S(sqrt(square)), S(v[0]));
}

/// A rotation is one or the orientation of a pose.
const auto& orientationOf(const auto& x) {
  if constexpr (requires { x.orient; }) {
    return x.orient;
  } else {
    return x;
  }
}

/// A number is one or an mtk::Scalar.
const auto& numberOf(const auto& x) { return x; }
template <class S>
const S& numberOf(const mtk::Scalar<S>& x) {
  return x.value();
}

}  // namespace slom::detail
