// The record of a single step: gain, acceptance, free directions and time.
#include <cmath>
#include <memory>
#include <sstream>
#include <type_traits>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using vec2 = mtk::vect<2>;

/// A line through points near it.
struct StraightLine {
  slom::Estimator est;
  slom::VarID<vec2> line = est.insertRV(vec2(0, 0), "line");
  explicit StraightLine(int points = 5) {
    for (int i = 0; i < points; ++i) {
      est.insertMeasurement([](const auto& l, double t) { return l[0] + l[1] * t; }, line, double(i),
                            slom::measured(1 + 2.0 * i + 0.1 * (i % 2)), slom::StandardDeviation(0.1));
    }
  }
};

TEST(StepRecord, IsTheGainAsPublished) {
  StraightLine fit;
  const double before = fit.est.getRSS();
  const double gain = fit.est.optimizeStep();
  EXPECT_DOUBLE_EQ(gain, (before - fit.est.getRSS()) / before);
  slom::Estimator& est = fit.est;
  while (est.optimizeStep() > 1e-6) {
  }
  static_assert(std::is_convertible_v<slom::StepRecord, double>);
  EXPECT_LT(std::abs(fit.est.optimizeStep()), 1e-6);
}

TEST(StepRecord, SaysWhatTheStepDid) {
  StraightLine fit;
  const double before = fit.est.getRSS();
  const slom::StepRecord step = fit.est.optimizeStep();
  EXPECT_EQ(step.rss_before, before);
  EXPECT_NEAR(step.rss_after, fit.est.getRSS(), 1e-12 * before);
  EXPECT_EQ(step.gain, double(step));
  EXPECT_TRUE(step.is_accepted);
  EXPECT_EQ(step.free_directions, 0);
  EXPECT_EQ(step.damping, 0);
  const slom::PhaseSeconds& p = step.phases;
  EXPECT_GT(p.linearize, 0);
  EXPECT_GE(step.seconds * 1.001, p.setup + p.linearize + p.factorize + p.solve);
}

TEST(StepRecord, OfARejectedStepHasNoGain) {
  StraightLine fit;
  fit.est.optimize();
  fit.est.changeAlgorithm(slom::LevenbergMarquardt());
  slom::StepRecord step;
  for (int i = 0; i < 20; ++i) step = fit.est.optimizeStep();
  const vec2 at = *fit.line;
  EXPECT_FALSE(step.is_accepted) << step;
  EXPECT_EQ(step.gain, 0);
  EXPECT_EQ(step.rss_before, step.rss_after);
  EXPECT_EQ(*fit.line, at);
}

TEST(StepRecord, CountsDirectionsThatDampingHides) {
  slom::Estimator est;
  est.changeAlgorithm(slom::LevenbergMarquardt());
  const auto a = est.insertRV(vec2(1, 1), "a"), b = est.insertRV(vec2(3, 1), "b");
  est.insertMeasurement([](const auto& x, const auto& y) { return (y - x).norm(); }, a, b,
                        slom::measured(1.5));
  EXPECT_EQ(est.optimizeStep().free_directions, 3);
  est.fix(a);
  EXPECT_EQ(est.optimizeStep().free_directions, 1);
  est.prior(b, vec2(2.5, 1), 1);
  EXPECT_EQ(est.optimizeStep().free_directions, 0);
}

TEST(StepRecord, DoesNotTakeARankFromAnEarlierStep) {
  slom::Estimator est;
  const auto x = est.insertRV(vec2(1, 1), "x");
  est.insertMeasurement([](const auto& v) { return mtk::vector(v[0] * v[0], v[1] * v[1] * v[1] - 0.25); }, x);
  EXPECT_EQ(est.optimizeStep().free_directions, 0);
  est.reinitRV(x, vec2(0, 1));  // where nothing depends on the first component
  est.changeAlgorithm(slom::LevenbergMarquardt());
  EXPECT_EQ(est.optimizeStep().free_directions, 1);
}

TEST(StepRecord, DoesNotCountThoseOfLargeProblems) {
  slom::Estimator est;
  est.changeAlgorithm(slom::LevenbergMarquardt());
  for (int i = 0; i <= slom::StepRecord::kMostUnknowns; ++i)
    est.insertMeasurement([](const auto& x) { return x - 1.0; }, est.insertRV(0.0));
  EXPECT_EQ(est.optimizeStep().free_directions, slom::StepRecord::kNotCounted);
  StraightLine many(slom::StepRecord::kMostResiduals + 1);
  many.est.changeAlgorithm(slom::LevenbergMarquardt());
  EXPECT_EQ(many.est.optimizeStep().free_directions, slom::StepRecord::kNotCounted);
  many.est.changeAlgorithm(slom::GaussNewton());
  EXPECT_EQ(many.est.optimizeStep().free_directions, 0) << "Gauss-Newton's step shows it at no cost";
}

/// Counting free directions between steps leaves the steps unchanged, to the last bit.
TEST(StepRecord, CountingDoesNotChangeTheNextStep) {
  const auto rosenbrock = [](const auto& v) { return mtk::vector(10.0 * (v[1] - v[0] * v[0]), 1.0 - v[0]); };
  vec2 counted, not_counted;
  for (const bool counts : {true, false}) {
    slom::Estimator est;
    est.changeAlgorithm(slom::LevenbergMarquardt());
    const auto x = est.insertRV(vec2(-1.2, 1), "x");
    est.insertMeasurement(rosenbrock, x);
    if (!counts) {  // residuals that are 0
      est.insertMeasurement(
          [](double y) { return Eigen::VectorXd::Constant(slom::StepRecord::kMostResiduals, y).eval(); },
          est.insertRV(0.0, false));
    }
    for (int i = 0; i < 8; ++i)
      EXPECT_EQ(est.optimizeStep().free_directions, counts ? 0 : slom::StepRecord::kNotCounted);
    (counts ? counted : not_counted) = *x;
  }
  EXPECT_EQ(counted, not_counted);
}

TEST(StepRecord, IsPrinted) {
  slom::StepRecord step;
  step.rss_before = 200;
  step.rss_after = 100;
  step.gain = 0.5;
  step.is_accepted = true;
  step.trials = 3;
  step.damping = 1e-4;
  step.free_directions = 2;
  step.seconds = 0.5;
  step.phases = {0.1, 0.2, 0.125, 0.0625};
  std::ostringstream text;
  text << step;
  EXPECT_EQ(
      text.str(),
      "RSS 200 -> 100, gain 0.5, 3 trials, damping 0.0001, 2 free directions; 0.5 s: setup 0.1, linearize 0.2, "
      "factorize 0.12, solve 0.062");
  step = {};
  text.str("");
  text << step;
  EXPECT_EQ(text.str(),
            "RSS 0 -> 0, gain 0, no step accepted; 0 s: setup 0, linearize 0, factorize 0, solve 0");
}

}  // namespace
