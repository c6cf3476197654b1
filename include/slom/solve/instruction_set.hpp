/// The instructions that dense arithmetic uses on this processor.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// "AVX-512", "AVX2" or "portable" (SSE2 on x86-64): the kernels of the factorisation, chosen at the first call. The environment variable
/// SLOM_KERNELS (avx512, avx2, sse2) chooses others. AVX-512 and AVX2 give the same bits. Throws [slom.bad-kernels] where the variable
/// names none, or some that the processor does not have.
const char* instructionSet();

}  // namespace slom
