/// Instructions that dense arithmetic uses on this processor.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Returns the kernels of the factorisation, chosen at the first call: "AVX-512", "AVX2" or "portable" (SSE2 on
/// x86-64). The environment variable SLOM_KERNELS (avx512, avx2, sse2) overrides the choice. AVX-512 and AVX2 give the
/// same bits. Throws [slom.bad-kernels] if the variable names no kernels, or kernels that the processor does not
/// support.
const char* instructionSet();

}  // namespace slom
