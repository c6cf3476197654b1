// Words for messages.
#pragma once

#include <cstddef>
#include <string>

namespace slom::calibration {

/// Returns `1 image`, `2 images`.
inline std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace slom::calibration
