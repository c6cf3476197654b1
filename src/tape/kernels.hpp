/// Instructions of tapes on lanes, compiled once for each instruction set and chosen at run time.
/// Register k of an arena is `lanes` numbers from k * lanes. Each kernel gives the same bits with AVX2 and AVX-512.
#pragma once

#include <cstddef>

#include "slom/tape/instruction.hpp"

namespace slom::tape {

inline constexpr int kManyLanes = 64, kFewLanes = 32;

struct Kernels {
  const char* name;  ///< name of the instruction set
  /// Executes `count` instructions on registers of 64 numbers.
  void (*run_many)(const Instruction* code, std::size_t count, double* arena);
  /// Executes `count` instructions on registers of 32 numbers.
  void (*run_few)(const Instruction* code, std::size_t count, double* arena);
  /// Sets to[i * lanes + k] = from[k][i] for i < size and k < lanes, a multiple of 8: numbers of measurements
  /// to registers.
  void (*gather)(const double* const* from, int size, int lanes, double* to);
  /// Sets to[k * size + i] = from[i][k] for i < size and k < lanes, a multiple of 8: registers to measurements.
  void (*scatter)(const double* const* from, int size, int lanes, double* to);
};

/// Returns the kernels for this processor. The environment variable SLOM_KERNELS chooses others, as for the solvers.
const Kernels& kernels();
/// Returns the kernels of an instruction set, "AVX-512", "AVX2" or "portable"; null if the processor does not have it.
const Kernels* kernelsNamed(const char* name);

}  // namespace slom::tape
