/// The angle between two vectors, for the checks of readings.
#pragma once

#include <cmath>

#include "mtk/types/vect.hpp"

namespace slom::detail {

/// Returns the angle between two vectors [rad], also where it is tiny or near pi.
template <class S>
S angleBetween(const mtk::vect<3, S>& a, const mtk::vect<3, S>& b) {
  using std::atan2;
  const mtk::vect<3, S> normal(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                               a[0] * b[1] - a[1] * b[0]);
  return atan2(normal.norm(), a.dot(b));
}

/// A degree in radians.
template <class S>
inline constexpr S degree = S(0.017453292519943295);

}  // namespace slom::detail
