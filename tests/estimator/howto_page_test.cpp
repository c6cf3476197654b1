// The code of docs/howto.md that is on no other page.
#include <iostream>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

struct TimedReading {
  double time, value;
};

TEST(Documentation, OfRecipesRuns) {
  const std::vector<TimedReading> first{{0, 1.02}, {1, 2.95}, {2, 5.04}, {3, 6.97}},
      second{{0.5, 2.71}, {1.5, 4.69}, {2.5, 6.71}};
  slom::Estimator est;
  // clang-format off
  auto level = est.insertRV(0.0, "level");
  auto slope = est.insertRV(0.0, "slope");
  auto offset = est.insertRV(0.0, "offset of the second sensor");
  for (const auto& r : first) {
    est.insertMeasurement([](const auto& l, const auto& s, double t) { return l + s * t; },
                          level, slope, r.time, slom::measured(r.value), slom::StandardDeviation(0.05), slom::named("first"));
  }
  for (const auto& r : second) {
    est.insertMeasurement([](const auto& l, const auto& s, const auto& o, double t) { return l + s * t + o; },
                          level, slope, offset, r.time, slom::measured(r.value), slom::StandardDeviation(0.02), slom::named("second"));
  }
  // clang-format on
  ::testing::internal::CaptureStdout();
  // clang-format off
  slom::Options options;
  options.max_seconds = 0.5;
  options.observer = slom::progressTable(std::cout);
  const slom::Summary summary = est.optimize(options);
  if (!summary.converged) std::cout << summary.message << "\n";
  // clang-format on
  const std::string text = ::testing::internal::GetCapturedStdout();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_NE(text.find("Gauss-Newton"), std::string::npos) << text;
  EXPECT_NEAR(*slope, 2, 0.03);
  EXPECT_NEAR(*offset, 0.7, 0.1);
  EXPECT_EQ(summary.groups.size(), 2u);
}

}  // namespace
