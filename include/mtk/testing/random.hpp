/// Random numbers for simulated measurements. Equal seeds give equal numbers on every machine, unlike the distributions
/// of the standard library:
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

/// Uniform and normal numbers from a 64-bit Mersenne twister, whose output the C++ standard fixes. Equal seeds give
/// equal numbers with any compiler, except for the last digits of the machine's log and cos.
class Random {
 public:
  /// Seeds the generator. Each `stream` is a separate sequence of the same seed, such as one for noise of cameras and
  /// one for noise of an IMU. Drawing more numbers from one stream does not change the others.
  explicit Random(std::uint64_t seed, std::uint32_t stream = 0) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
    engine_.seed(sequence);
  }

  /// Returns a uniform number in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Returns a normal number with mean 0 and standard deviation 1.
  ///   source   Box and Muller, "A note on the generation of random normal deviates", 1958
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mtk::testing
