/// Random numbers for simulated measurements. Equal seeds give equal numbers on every machine, which the distributions of the
/// standard library do not promise:
///
///     mtk::testing::Random noise(42, 0);
///     const double measured = range + 0.1 * noise.normal();  // standard deviation 0.1
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "mtk/detail/cpp20.hpp"

namespace mtk::testing {

/// Uniform and normal numbers from a 64-bit Mersenne twister, whose output the C++ standard fixes. Equal
/// seeds give equal numbers with any compiler, but for the last digits of the machine's log and cos.
class Random {
 public:
  /// Each `stream` is a sequence of its own of the same seed, as for noise of cameras and noise of an IMU: more numbers
  /// drawn from one leave the others as they were.
  explicit Random(std::uint64_t seed, std::uint32_t stream = 0) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
    engine_.seed(sequence);
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Normal with mean 0 and standard deviation 1.
  ///   source   Box and Muller, "A note on the generation of random normal deviates", 1958
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mtk::testing
