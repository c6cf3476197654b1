// Counts of whole problems, which summaries and lines hold as int.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "mtk/error.hpp"

namespace slom::distributed {

/// Throws [slom.io.too-large] if the whole file has more than int counts. `what`: `lines`.
inline void requireCountable(const std::string& file, std::int64_t count, const char* what,
                             const char* remedy) {
  constexpr std::int64_t most = std::numeric_limits<int>::max();
  if (count > most)
    throw mtk::Error("slom.io.too-large",
                     fmt::format("{}: {} {}, more than {}, the limit; {}", file, count, what, most, remedy),
                     file);
}

}  // namespace slom::distributed
