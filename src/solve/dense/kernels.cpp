#include "kernels.hpp"

#include "base/processor.hpp"
#include "slom/solve/instruction_set.hpp"

namespace slom {

namespace dense {

extern const Kernels kPortableKernels;
#if defined(__x86_64__)
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

namespace {

const Kernels& kernelsOf(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return kAvx512Kernels;
  if (set == InstructionSet::avx2) return kAvx2Kernels;
#endif
  static_cast<void>(set);
  return kPortableKernels;
}

}  // namespace

const Kernels& kernels() {
  static const Kernels& chosen = kernelsOf(chosenInstructionSet());
  return chosen;
}

}  // namespace dense

const char* instructionSet() { return dense::kernels().name; }

}  // namespace slom
