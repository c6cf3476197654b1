/// The instructions of a tape. Operands are a, b, c, d, e, f, g in this order.
#pragma once

#include <cstdint>

#include "slom/tape/instruction.hpp"

namespace slom::tape {

// Sums of products. The letters p and m are the signs of the products, then of the single term s.
// clang-format off
#define SLOM_TAPE_SUMS(X)                                     \
  X(p, 2) X(m, 2)                                             \
  X(pp, 4) X(pm, 4) X(mm, 4)                                  \
  X(ppp, 6) X(ppm, 6) X(pmm, 6) X(mmm, 6)                     \
  X(p_sp, 3) X(p_sm, 3) X(m_sp, 3) X(m_sm, 3)                 \
  X(pp_sp, 5) X(pm_sp, 5) X(mm_sp, 5)                         \
  X(pp_sm, 5) X(pm_sm, 5) X(mm_sm, 5)                         \
  X(ppp_sp, 7) X(ppm_sp, 7) X(pmm_sp, 7) X(mmm_sp, 7)         \
  X(ppp_sm, 7) X(ppm_sm, 7) X(pmm_sm, 7) X(mmm_sm, 7)
#define SLOM_TAPE_SIMPLE(X)                                                                          \
  X(copy, 1) X(add, 2) X(subtract, 2) X(negate, 1) X(negated_sum, 2) X(divide, 2) X(reciprocal, 1) X(scale, 2)    \
  X(inverse_arc, 2) X(sign, 1) X(abs, 1) X(floor, 1) X(wrap, 1) X(sqrt, 1) X(sin, 1) X(cos, 1)       \
  X(sin_cos, 2) X(tan, 1) X(asin, 1) X(acos, 1) X(atan, 1) X(sinh, 1) X(cosh, 1) X(tanh, 1)          \
  X(asinh, 1) X(acosh, 1) X(atanh, 1) X(exp, 1) X(expm1, 1) X(log, 1) X(log1p, 1) X(cbrt, 1)         \
  X(erf, 1) X(erfc, 1) X(atan2, 2) X(hypot, 2) X(pow, 2) X(less, 2) X(less_equal, 2) X(equal, 2) X(both, 2)     \
  X(either, 2) X(opposite, 1) X(select, 3)
// clang-format on

enum class Kind : std::uint16_t {
#define SLOM_TAPE_KIND(name, operands) name,
  SLOM_TAPE_SIMPLE(SLOM_TAPE_KIND) SLOM_TAPE_SUMS(SLOM_TAPE_KIND)
#undef SLOM_TAPE_KIND
};

inline constexpr int kOperandsOfKind[]{
#define SLOM_TAPE_OPERANDS(name, operands) operands,
    SLOM_TAPE_SIMPLE(SLOM_TAPE_OPERANDS) SLOM_TAPE_SUMS(SLOM_TAPE_OPERANDS)
#undef SLOM_TAPE_OPERANDS
};
inline constexpr int kKinds = sizeof(kOperandsOfKind) / sizeof(int);

/// Returns whether the second operand of the instruction is a second result: the cosine beside the sine.
constexpr bool hasTwoResults(Kind kind) { return kind == Kind::sin_cos; }

}  // namespace slom::tape
