/// Rotation vectors so long that their squares overflow.
#pragma once

#include <cmath>
#include <limits>

#include "mtk/scalar.hpp"

namespace mtk::detail {

/// Longest rotation vector [rad] whose square is finite. Longer ones are shortened to it; their sines are rounding
/// errors anyway.
template <class S>
inline constexpr built_in_t<S> kLongestTurn = std::numeric_limits<built_in_t<S>>::max_exponent > 200
                                                  ? built_in_t<S>(1e150)
                                                  : built_in_t<S>(1e15);
template <class S>
S shortenedTurn(const S& angle) {
  using std::abs;
  const S longest = S(kLongestTurn<S> / built_in_t<S>(2));
  return select(abs(angle) > longest, S(angle * S(longest / abs(angle))), angle);
}

}  // namespace mtk::detail
