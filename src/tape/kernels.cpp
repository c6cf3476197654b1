#include "tape/kernels.hpp"

namespace slom::tape {

extern const Kernels kPortableTapeKernels;
#if defined(__x86_64__)
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

const Kernels& kernelsOf(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return kAvx512Kernels;
  if (set == InstructionSet::avx2) return kAvx2Kernels;
#endif
  static_cast<void>(set);
  return kPortableTapeKernels;
}

const Kernels& kernels() {
  static const Kernels& chosen = kernelsOf(chosenInstructionSet());
  return chosen;
}

}  // namespace slom::tape
