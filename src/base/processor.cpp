#include "base/processor.hpp"

#include <cstdlib>
#include <string>

#include "mtk/error.hpp"

namespace slom {

namespace {

[[noreturn]] void raiseBadKernels(const std::string& wanted, const char* why) {
  throw mtk::Error("slom.bad-kernels",
                   "the environment variable SLOM_KERNELS is \"" + wanted + "\", " + why +
                       "; set it to avx512, avx2 or sse2, or unset it",
                   "SLOM_KERNELS");
}

}  // namespace

bool hasInstructionSet(InstructionSet set) {
  if (set == InstructionSet::portable) return true;
#if defined(__x86_64__)
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has_avx2 && (set == InstructionSet::avx2 ||
                      (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                       __builtin_cpu_supports("avx512dq")));
#else
  return false;
#endif
}

InstructionSet chosenInstructionSet() {
  const char* const variable = std::getenv("SLOM_KERNELS");
  const std::string wanted = variable == nullptr ? "" : variable;
  if (wanted.empty()) {
    if (hasInstructionSet(InstructionSet::avx512)) return InstructionSet::avx512;
    return hasInstructionSet(InstructionSet::avx2) ? InstructionSet::avx2 : InstructionSet::portable;
  }
  if (wanted != "sse2" && wanted != "avx2" && wanted != "avx512")
    raiseBadKernels(wanted, "which names no kernels");
  const InstructionSet set = wanted == "sse2"   ? InstructionSet::portable
                             : wanted == "avx2" ? InstructionSet::avx2
                                                : InstructionSet::avx512;
  if (!hasInstructionSet(set)) raiseBadKernels(wanted, "which this processor does not have");
  return set;
}

}  // namespace slom
