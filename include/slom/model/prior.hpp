/// The function of a prior, which returns the variable itself. See slom/measurements/prior.hpp.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

struct Prior {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& x) const { return x; }
};

}  // namespace slom
