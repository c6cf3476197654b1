/// An instruction of a tape. This header is compiled for several instruction sets, so it includes nothing of its own.
#pragma once

#include <cstdint>

#include "mtk/detail/cpp20.hpp"

namespace slom::tape {

/// One operation on registers. src/tape/instructions.hpp lists the kinds and their operands.
struct Instruction {
  static constexpr int kMostOperands = 7;
  std::uint16_t kind = 0;
  std::uint16_t to = 0;  ///< register of the result
  std::uint16_t from[kMostOperands] = {};
  bool operator==(const Instruction&) const = default;
};

}  // namespace slom::tape
