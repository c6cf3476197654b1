/// What may follow a measurement in insertMeasurement, each at most once and in any order: its uncertainty, its loss.
#pragma once

#include <cstddef>

#include "slom/model/loss.hpp"
#include "slom/model/noise.hpp"

namespace slom::detail {

template <class T>
inline constexpr bool is_trailing = IsNoise<T> || IsLoss<T>;

/// How many of the last arguments are such ones.
template <class... Args>
constexpr std::size_t trailingCount() {
  constexpr bool flags[] = {false, is_trailing<Args>...};
  std::size_t count = 0;
  while (count < sizeof...(Args) && flags[sizeof...(Args) - count]) ++count;
  return count;
}

/// The numbers of the uncertainty among the arguments, unit covariance when there is none.
inline NoiseView findNoise() { return {}; }
template <class First, class... Rest>
NoiseView findNoise(const First& first, const Rest&... rest) {
  if constexpr (IsNoise<First>) {
    static_assert(!(IsNoise<Rest> || ...),
                  "slom: the uncertainty of the measurement is given twice: pass one of "
                  "Covariance, StandardDeviation, InvCovariance or InvStandardDeviation");
    return viewNoise(first);
  } else {
    return findNoise(rest...);
  }
}

/// The loss among the arguments, none when there is none.
inline Loss findLoss() { return {}; }
template <class First, class... Rest>
Loss findLoss(const First& first, const Rest&... rest) {
  if constexpr (IsLoss<First>) {
    static_assert(!(IsLoss<Rest> || ...),
                  "slom: the loss of the measurement is given twice: pass one of Huber, "
                  "PseudoHuber, Cauchy, Tukey, GemanMcClure or Barron");
    return first;
  } else {
    return findLoss(rest...);
  }
}

}  // namespace slom::detail
