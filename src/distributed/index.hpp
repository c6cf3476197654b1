/// Indices are int in interfaces and std::size_t in containers.
#pragma once

#include <cstddef>

namespace slom::distributed {

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace slom::distributed
