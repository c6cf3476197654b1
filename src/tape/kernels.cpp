#include "tape/kernels.hpp"

#include <cstdlib>
#include <string_view>

namespace slom::tape {

extern const Kernels kPortableTapeKernels;
#if defined(__x86_64__)
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

namespace {

bool hasAvx2ForTapes() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}
bool hasAvx512ForTapes() {
#if defined(__x86_64__)
  return hasAvx2ForTapes() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq");
#else
  return false;
#endif
}

const Kernels& chooseForTapes() {
  const char* const variable = std::getenv("SLOM_KERNELS");
  const std::string_view wanted = variable == nullptr ? "" : variable;
  const Kernels* chosen = wanted == "sse2" ? kernelsNamed("portable") : nullptr;
  if (chosen == nullptr && wanted != "avx2") chosen = kernelsNamed("AVX-512");
  if (chosen == nullptr) chosen = kernelsNamed("AVX2");
  return chosen != nullptr ? *chosen : kPortableTapeKernels;
}

}  // namespace

const Kernels* kernelsNamed(const char* name) {
  const std::string_view wanted = name;
#if defined(__x86_64__)
  if (wanted == kAvx512Kernels.name) return hasAvx512ForTapes() ? &kAvx512Kernels : nullptr;
  if (wanted == kAvx2Kernels.name) return hasAvx2ForTapes() ? &kAvx2Kernels : nullptr;
#endif
  return wanted == kPortableTapeKernels.name ? &kPortableTapeKernels : nullptr;
}

const Kernels& kernels() {
  static const Kernels& chosen = chooseForTapes();
  return chosen;
}

}  // namespace slom::tape
