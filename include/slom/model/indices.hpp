/// Selection from a list of types.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace slom::detail {

/// Returns the positions of the true values as a std::index_sequence.
template <bool... Wanted>
constexpr auto indicesWhere() {
  constexpr std::size_t count = (std::size_t{Wanted} + ... + 0);
  constexpr auto index = [] {
    constexpr std::array<bool, sizeof...(Wanted)> wanted{Wanted...};
    std::array<std::size_t, count> result{};
    std::size_t next = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i]) result[next++] = i;
    }
    return result;
  }();
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::index_sequence<index[I]...>{};
  }(std::make_index_sequence<count>{});
}

}  // namespace slom::detail
