/// Indices are int in interfaces, as Eigen's and the solver's are, and std::size_t in containers.
#pragma once

#include <cstddef>

namespace slom {

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace slom
