// Kernels for processors with AVX-512 (F, VL and DQ), compiled with these enabled.
#include "kernels.inl"

namespace slom::dense {
extern const Kernels kAvx512Kernels;
const Kernels kAvx512Kernels = makeKernels("AVX-512");
}  // namespace slom::dense
