// Seeds that differ from run to run. SLOM_TEST_SEED=N repeats a run with the seed that it printed.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <random>

namespace slom::testing {

/// Returns the seed of SLOM_TEST_SEED, or a new one, and prints it.
inline unsigned freshSeed() {
  const char* const given = std::getenv("SLOM_TEST_SEED");
  const unsigned seed = given ? unsigned(std::strtoul(given, nullptr, 10)) : std::random_device()();
  std::printf("SLOM_TEST_SEED=%u\n", seed);
  return seed;
}

}  // namespace slom::testing
