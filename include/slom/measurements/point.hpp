/// Arguments of the ready measurements: what counts as a point, a rotation or a number.
#pragma once

#include "mtk/types/scalar.hpp"
#include "mtk/types/vect.hpp"

namespace slom::detail {

/// Returns the point: a vector, or the position of a pose.
const auto& positionOf(const auto& x) {
  if constexpr (requires { x.pos; }) {
    return x.pos;
  } else {
    return x;
  }
}

/// Returns |v|. At v = 0, where all directions are equal, the derivative is that along the first axis. So a fit that
/// starts there moves away.
auto lengthOf(const auto& v) {
  using mtk::select;
  using std::sqrt;
  const auto square = v.squaredNorm();
  using S = std::decay_t<decltype(square)>;
  return select(square > S(0), S(sqrt(square)), S(v[0]));
}

/// Returns the rotation: the argument itself, or the orientation of a pose.
const auto& orientationOf(const auto& x) {
  if constexpr (requires { x.orient; }) {
    return x.orient;
  } else {
    return x;
  }
}

/// Returns the number: the argument itself, or the value of an mtk::Scalar.
const auto& numberOf(const auto& x) { return x; }
template <class S>
const S& numberOf(const mtk::Scalar<S>& x) {
  return x.value();
}

}  // namespace slom::detail
