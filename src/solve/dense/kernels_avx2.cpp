// Kernels for processors with AVX2 and FMA, compiled with these enabled.
#include "kernels.inl"

namespace slom::dense {
extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = makeKernels("AVX2");
}  // namespace slom::dense
