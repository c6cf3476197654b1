// Random numbers are the same everywhere and have the distribution they claim.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>

namespace {

using mtk::testing::Random;

/// The numbers of the first version. They must never change, because stored data are made from them.
TEST(Random, UniformNumbersAreFixedByTheSeed) {
  Random random(1, 0);
  EXPECT_EQ(random.uniform(), 0x1.8451f002ab5d8p-1);
  EXPECT_EQ(random.uniform(), 0x1.25dba652c5665p-1);
  EXPECT_EQ(random.uniform(), 0x1.b22cfd93c513p-1);
  Random large_seed(0x123456789abcdef, 3);
  EXPECT_EQ(large_seed.uniform(), 0x1.f01783d42c284p-1);
}

TEST(Random, SeedsAndStreamsDiffer) {
  const double base = Random(1, 0).uniform();
  EXPECT_NE(base, Random(2, 0).uniform());
  EXPECT_NE(base, Random(1, 1).uniform());
  EXPECT_NE(base, Random(std::uint64_t{1} << 32, 0).uniform());
}

/// Returns the Kolmogorov-Smirnov distance from the normal distribution, in units in which 1.95 is exceeded once in
/// 1000 trials.
double distanceFromNormal(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const double n = static_cast<double>(samples.size());
  double distance = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double expected = 0.5 * std::erfc(-samples[i] / std::sqrt(2.0));
    distance = std::max({distance, std::abs(expected - static_cast<double>(i) / n),
                         std::abs(expected - static_cast<double>(i + 1) / n)});
  }
  return distance * std::sqrt(n);
}

TEST(Random, NormalNumbersAreNormal) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Random random(seed, 0);
    std::vector<double> samples(100000);
    for (double& sample : samples) sample = random.normal();
    EXPECT_LT(distanceFromNormal(samples), 1.95) << "seed " << seed;
    EXPECT_GT(*std::max_element(samples.begin(), samples.end()), 3.5) << "seed " << seed;
  }
}

}  // namespace
