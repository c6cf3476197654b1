// The restart of a fit: long first steps end without full rank, short steps make a second attempt, and the better one
// counts.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/classics/models.hpp"

namespace {

using slom::StopReason;

/// One of the classical problems, by its number, from a multiple of its published start.
class ClassicFit {
 public:
  ClassicFit(int number, double factor) {
    const slom::testing::classics::Classic& classic =
        slom::testing::classics::all()[static_cast<std::size_t>(number - 1)];
    const auto n = static_cast<Eigen::Index>(classic.start.size());
    const Eigen::VectorXd start = factor * Eigen::Map<const Eigen::VectorXd>(classic.start.data(), n);
    x = est.insertRV(start, "x");
    const auto f = [number, rows = classic.residuals](const Eigen::VectorXd& at) {
      Eigen::VectorXd r(rows);
      slom::testing::classics::residuals(number, at.data(), static_cast<int>(at.size()), r.data());
      return r;
    };
    est.insertMeasurement(f, x);
  }
  slom::Estimator est;
  slom::VarID<Eigen::VectorXd> x;
};

TEST(Restart, FindsTheMinimumThatLongFirstStepsMiss) {
  ClassicFit bard(8, 10);
  const slom::Summary summary = bard.est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_NEAR(summary.final_rss, 8.21487730657897e-3, 1e-12);
  EXPECT_EQ(summary.final_rss, bard.est.getRSS());
  ASSERT_EQ(summary.warnings.size(), 1u) << summary;
  EXPECT_EQ(summary.warnings[0],
            "iteration 5: rank deficient; the fit began again from the start with short steps of "
            "Levenberg-Marquardt");
  ASSERT_GT(summary.trace.size(), 6u);
  EXPECT_EQ(summary.trace[5].algorithm, "Gauss-Newton");
  EXPECT_EQ(summary.trace[6].algorithm, "Levenberg-Marquardt");
  EXPECT_GT(summary.trace[6].damping, 100) << "steps are short";
}

TEST(Restart, IsLeftOutWithoutFallBack) {
  ClassicFit bard(8, 10);
  slom::Options options;
  options.fall_back = false;
  const slom::Summary summary = bard.est.optimize(options);
  EXPECT_EQ(summary.stop_reason, StopReason::rank_deficient) << summary;
  EXPECT_EQ(summary.iterations, 5);
}

TEST(Restart, EndsWithTheBetterValuesOfTwoAttemptsThatFail) {
  ClassicFit freudenstein_and_roth(2, 1);
  const slom::Summary summary = freudenstein_and_roth.est.optimize();
  EXPECT_EQ(summary.stop_reason, StopReason::rank_deficient) << summary;
  for (const std::string& warning : summary.warnings)
    EXPECT_EQ(warning.find("began again"), std::string::npos) << warning;
  double least = summary.initial_rss;
  int rises = 0;
  for (std::size_t i = 1; i < summary.trace.size(); ++i) {
    least = std::min(least, summary.trace[i].rss);
    rises += summary.trace[i].rss > 1.1 * summary.trace[i - 1].rss;
  }
  EXPECT_EQ(rises, 1) << "the second attempt begins at the start\n" << summary;
  EXPECT_NEAR(summary.final_rss, least, 1e-10 * least);
  EXPECT_EQ(summary.final_rss, freudenstein_and_roth.est.getRSS());
}

}  // namespace
