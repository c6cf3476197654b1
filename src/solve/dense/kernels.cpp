#include "kernels.hpp"

#include <cstdlib>
#include <string>

#include "mtk/error.hpp"
#include "slom/solve/instruction_set.hpp"

namespace slom {

namespace dense {

extern const Kernels kPortableKernels;
#if defined(__x86_64__)
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

namespace {

bool hasAvx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

bool hasAvx512() {
#if defined(__x86_64__)
  return hasAvx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq");
#else
  return false;
#endif
}

[[noreturn]] void raiseUnknown(const std::string& wanted, const char* why) {
  throw mtk::Error("slom.bad-kernels",
                   "the environment variable SLOM_KERNELS is \"" + wanted + "\", " + why +
                       "; set it to avx512, avx2 or sse2, or unset it",
                   "SLOM_KERNELS");
}

const Kernels& choose() {
  const char* const variable = std::getenv("SLOM_KERNELS");
  const std::string wanted = variable == nullptr ? "" : variable;
  if (wanted == "sse2") return kPortableKernels;
  if (!wanted.empty() && wanted != "avx2" && wanted != "avx512")
    raiseUnknown(wanted, "which names no kernels");
  if ((wanted == "avx2" && !hasAvx2()) || (wanted == "avx512" && !hasAvx512()))
    raiseUnknown(wanted, "which this processor does not have");
#if defined(__x86_64__)
  if (hasAvx512() && wanted != "avx2") return kAvx512Kernels;
  if (hasAvx2()) return kAvx2Kernels;
#endif
  return kPortableKernels;
}

}  // namespace

const Kernels& kernels() {
  static const Kernels& chosen = choose();
  return chosen;
}

}  // namespace dense

const char* instructionSet() { return dense::kernels().name; }

}  // namespace slom
