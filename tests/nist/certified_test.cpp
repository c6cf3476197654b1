// NIST's problems of nonlinear regression, from both starts of each, against the certified values.
#include <gtest/gtest.h>

#include "support/nist/fit.hpp"
#include "support/paths.hpp"

namespace {

using namespace slom::testing::nist;

std::vector<Problem> problems() { return readProblems(slom::testing::sharedDataPath("nist")); }

/// Digits that must agree with the certified ones.
struct Demand {
  double parameters = 10, deviations = 9, rss = 9;
};

Demand demandFor(const std::string& problem) {
  // The data were generated to 14 digits from the model itself: the residuals are 1e-13, the rounding errors of the
  // predictions 1e-16, so 2 to 3 digits of the RSS, and of sigma, are all that double precision can resolve.
  if (problem == "Lanczos1") return {10, 2, 2};
  return {};
}

TEST(Nist, ModelsHaveTheCertifiedRssAtTheCertifiedParameters) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("nist");
  EXPECT_EQ(problems().size(), 27u);
  for (const Problem& problem : problems()) {
    double rss = 0;
    for (const Datum& datum : problem.data) {
      const double r = predict(problem.model, problem.parameters, datum.x) - datum.y;
      rss += r * r;
    }
    // 1e-18: that the parameters are rounded to 11 digits moves the predictions by some 1e-10.
    EXPECT_NEAR(rss, problem.rss, 1e-8 * problem.rss + 1e-18) << problem.name;
  }
}

TEST(Nist, LevenbergMarquardtFindsTheCertifiedValuesFromBothStarts) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("nist");
  for (const Problem& problem : problems()) {
    const Demand demand = demandFor(problem.name);
    for (const Eigen::VectorXd& start : problem.starts) {
      SCOPED_TRACE(::testing::Message() << problem.name << " from " << start.transpose());
      const Fit fit = fitBySlom(problem, start, slom::LevenbergMarquardt(kCautiousDamping), toTheLastDigit());
      EXPECT_TRUE(fit.converged);
      EXPECT_GE(digits(fit.parameters, problem.parameters), demand.parameters) << fit.parameters.transpose();
      EXPECT_GE(digits(fit.deviations, problem.deviations), demand.deviations) << fit.deviations.transpose();
      EXPECT_GE(digits(fit.rss, problem.rss), demand.rss) << fit.rss;
    }
  }
}

TEST(Nist, TheDefaultsFindEightDigitsFromBothStarts) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("nist");
  for (const Problem& problem : problems()) {
    for (const Eigen::VectorXd& start : problem.starts) {
      SCOPED_TRACE(::testing::Message() << problem.name << " from " << start.transpose());
      const Fit fit = fitAsItComes(problem, start);
      EXPECT_TRUE(fit.converged);
      EXPECT_GE(digits(fit.parameters, problem.parameters), 8) << fit.parameters.transpose();
    }
  }
}

}  // namespace
