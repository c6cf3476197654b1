// The instruction sets that kernels are compiled for, and the one that they use.
#pragma once

namespace slom {

enum class InstructionSet { portable, avx2, avx512 };

/// Returns whether this processor has the instruction set: AVX2 with FMA; AVX-512 F, VL and DQ besides.
bool hasInstructionSet(InstructionSet set);
/// Returns the widest instruction set of this processor, or the one that the environment variable SLOM_KERNELS names.
/// Throws [slom.bad-kernels].
InstructionSet chosenInstructionSet();

}  // namespace slom
