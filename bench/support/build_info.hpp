/// Conditions of a measured time besides the code: compiler, flags, instructions, processor.
#pragma once

#include <string>

namespace slom::bench {

std::string compilerName();
/// Returns the flags as CMake passes them.
std::string compileFlags();
/// Returns the vector instructions of this build, such as `AVX2 FMA`.
std::string instructionSet();
/// Returns the processor's name; empty if /proc/cpuinfo does not state it.
std::string processorName();
/// Returns the library that provides BLAS to CHOLMOD, such as `libf77blas.so.3` (ATLAS) or
/// `openblas-serial/libblas.so.3`; empty if there is none.
std::string blasLibrary();

}  // namespace slom::bench
