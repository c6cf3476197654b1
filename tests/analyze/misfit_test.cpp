// Warnings of a fit with misfit: residuals far from their standard deviations, and losses that nearly ignore all data.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using Texts = std::vector<std::string>;

/// A mean of 20 data, which scatter by 1, with this standard deviation.
slom::Summary fit(double stated) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  for (int i = 0; i < 20; ++i) {
    est.insertMeasurement([](const auto& v, const double& y) { return v - y; }, x, 5 + (i % 2 ? 1.0 : -1.0),
                          slom::StandardDeviation(stated), slom::named("mean"));
  }
  return est.optimize();
}

TEST(Misfit, OfChiSquareIsAWarning) {
  EXPECT_EQ(fit(1).warnings, Texts());
  EXPECT_EQ(fit(0.4).warnings, Texts());
  EXPECT_EQ(fit(0.01).warnings,
            Texts{"chi-square / dof is 1.05e+04, where about 1 is expected from the stated standard "
                  "deviations: the model or its derivatives do not "
                  "fit the data, some data are wrong, or the standard deviations are "
                  "1e+02 times too small; slom::outliers(est) names the worst "
                  "data, Sigma::estimated takes the scale from the residuals"});
  EXPECT_EQ(fit(100).warnings,
            Texts{"chi-square / dof is 0.000105, where about 1 is expected from the stated "
                  "standard deviations: the standard deviations are "
                  "97 times too large; slom::outliers(est) names the worst data, Sigma::estimated "
                  "takes the scale from the residuals"});
}

TEST(Misfit, OfALossThatLetsHardlyAnythingCountIsAWarning) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  for (int i = 0; i < 20; ++i) {
    est.insertMeasurement([](const auto& v, const double& y) { return v - y; }, x, 100.0 * i,
                          slom::StandardDeviation(1), slom::Cauchy(2), slom::named("far"));
  }
  const slom::Summary summary = est.optimize();
  ASSERT_FALSE(summary.warnings.empty());
  EXPECT_EQ(summary.warnings.back().rfind(
                "the loss Cauchy(2) gives weights below 1/2 to 19 of 20 measurements far, so hardly any of "
                "them counts, ",
                0),
            0u)
      << summary.warnings.back();
}

TEST(Misfit, OfLossesOfManyScalesIsAWarning) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  for (int i = 0; i < 20; ++i) {
    est.insertMeasurement([](const auto& v, const double& y) { return v - y; }, x, 100.0 * i,
                          slom::StandardDeviation(1), slom::Cauchy(2 + 0.01 * i), slom::named("far"));
  }
  const slom::Summary summary = est.optimize();
  ASSERT_FALSE(summary.warnings.empty());
  EXPECT_EQ(summary.warnings.back().rfind("losses such as Cauchy(2) give weights below 1/2 to ", 0), 0u)
      << summary.warnings.back();
}

/// Returns the warnings for `unknowns` numbers, each measured four times as 1 and twice by another group that is off by
/// `off` deviations. `is_robust`: also with a measurement that has a loss.
Texts warningsOfGroups(int unknowns, double off, bool is_robust) {
  slom::Estimator est;
  for (int k = 0; k < unknowns; ++k) {
    const auto x = est.insertRV(0.0, "x" + std::to_string(k));
    for (int i = 0; i < 4; ++i) {
      est.insertMeasurement([](const auto& v, const double& y) { return v - y; }, x, i % 2 ? 1.0 : -1.0,
                            slom::StandardDeviation(1), slom::named("good"));
    }
    for (int i = 0; i < 2; ++i) {
      est.insertMeasurement([](const auto& v, const double& y) { return v - y; }, x, i % 2 ? off : -off,
                            slom::StandardDeviation(1), slom::named("bad"));
    }
    if (is_robust && k == 0) {
      est.insertMeasurement([](const auto& v, const double& y) { return v - y; }, x, 0.0,
                            slom::StandardDeviation(1), slom::Huber(1.345), slom::named("robust"));
    }
  }
  return est.optimize().warnings;
}

TEST(Misfit, OfAGroupIsAWarningInProblemsOfAnySizeAndBesideLosses) {
  for (const int unknowns : {10, 41, 200}) {
    for (const bool is_robust : {false, true}) {
      EXPECT_EQ(warningsOfGroups(unknowns, 1, is_robust), Texts()) << unknowns;
      const Texts warnings = warningsOfGroups(unknowns, 4, is_robust);
      ASSERT_EQ(warnings.size(), 1u) << unknowns << is_robust;
      EXPECT_EQ(warnings[0].rfind("chi-square / dof of measurements bad is ", 0), 0u) << warnings[0];
    }
  }
}

TEST(Misfit, OfFewDataIsAWarningWhereItCannotBeChance) {
  const auto warningsOf = [](double off) {
    slom::Estimator est;
    const auto x = est.insertRV(0.0, "x");
    for (const double y : {0.0, off}) {
      est.insertMeasurement([](const auto& v, const double& z) { return v - z; }, x, y,
                            slom::StandardDeviation(1));
    }
    return est.optimize().warnings;
  };
  EXPECT_TRUE(warningsOf(10).empty());  // chi-square / dof is 50
  EXPECT_EQ(warningsOf(1e6).size(), 1u);
}

}  // namespace
