/// Instructions of tapes on lanes, compiled once for each instruction set and chosen at run time.
/// Register k of an arena is `lanes` numbers from k * lanes. Each kernel gives the same bits with AVX2 and AVX-512.
#pragma once

#include <cstddef>

#include "base/processor.hpp"
#include "slom/tape/instruction.hpp"

namespace slom::tape {

inline constexpr int kManyLanes = 64, kFewLanes = 32;

struct Kernels {
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

/// Returns the kernels of the chosen instruction set. Throws as chosenInstructionSet does.
const Kernels& kernels();
/// Returns the kernels of an instruction set, whether the processor has it or not.
const Kernels& kernelsOf(InstructionSet set);

}  // namespace slom::tape
