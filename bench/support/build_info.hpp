/// What a measured time depends on besides the code: compiler, flags, instructions, processor.
#pragma once

#include <string>

namespace slom::bench {

std::string compilerName();
/// As CMake passes them.
std::string compileFlags();
/// The vector instructions that this build uses, as in `AVX2 FMA`.
std::string instructionSet();
/// The processor's name, empty where /proc/cpuinfo does not state it.
std::string processorName();
/// The library that provides BLAS to CHOLMOD, as in `libf77blas.so.3` (ATLAS) or `openblas-serial/libblas.so.3`; empty without
/// one.
std::string blasLibrary();

}  // namespace slom::bench
