// Kernels for any processor.
#include "kernels.inl"

namespace slom::dense {
extern const Kernels kPortableKernels;
const Kernels kPortableKernels = makeKernels("portable");
}  // namespace slom::dense
