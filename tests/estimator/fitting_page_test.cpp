// The code of the section on robust losses in docs/outliers.md.
#include <iostream>

#include <gtest/gtest.h>

#include "support/robust_line.hpp"

namespace {

TEST(Documentation, OfOutliersRuns) {
  const std::vector<slom::testing::Point> points = slom::testing::linePoints(20);
  slom::Estimator est;
  const auto line = est.insertRV(Eigen::Vector2d(14, -4), "line");
  for (const auto& p : points) {
    // clang-format off
    est.insertMeasurement([](const auto& l, double x, double y) { return l[0] + l[1] * x - y; }, line, p.x, p.y,
                          slom::StandardDeviation(0.1), slom::Huber(1.345));
    // clang-format on
  }
  ::testing::internal::CaptureStdout();
  slom::Options options;
  options.graduated_non_convexity = true;
  std::cout << est.optimize(options);
  const std::string text = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(text.substr(0, 10), "Converged:") << text;
  EXPECT_LT((*line - Eigen::Vector2d(1, 2)).norm(), 0.3) << line->transpose();
}

}  // namespace
