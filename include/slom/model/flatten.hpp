/// SLOM_FLATTEN: inlining of whole formulas.
#pragma once

#include "mtk/detail/cpp20.hpp"
#include "mtk/detail/sanitizers.hpp"

/// Marks a function to be compiled as one piece with all functions that it calls, so dual numbers stay in registers. It
/// is empty under sanitizers and with SLOM_NO_FLATTEN, which compile faster.
#if defined(__GNUC__) && !defined(MTK_ADDRESS_SANITIZER) && !defined(SLOM_NO_FLATTEN)
#define SLOM_FLATTEN __attribute__((flatten))
#else
#define SLOM_FLATTEN
#endif
