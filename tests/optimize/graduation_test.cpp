// Graduated non-convexity: bad starts and gross outliers, stages, stop reasons.
#include <cstdio>
#include <sstream>

#include <gtest/gtest.h>

#include "support/message_of.hpp"
#include "support/robust_line.hpp"

namespace {

using namespace slom::testing;
using Eigen::Vector2d;
using Eigen::Vector3d;

slom::Options graduated() {
  slom::Options options;
  options.graduated_non_convexity = true;
  return options;
}

/// Returns the least squares line of the points that are not outliers.
Vector2d inlierLine(const std::vector<Point>& points) {
  std::vector<Point> inliers;
  for (const Point& p : points) {
    if (!p.is_outlier) inliers.push_back(p);
  }
  return reweightedLine(Vector2d(0, 0), inliers, 1, [](Real) -> Real { return 1; });
}

TEST(Graduation, FindsTheLineWhereLeastSquaresAndThePlainLossFail) {
  const std::vector<Point> points = linePoints(40);
  const Vector2d inliers = inlierLine(points), bad_start(14, -4);
  LineFit squares(bad_start, points), plain(bad_start, points, slom::GemanMcClure(3));
  EXPECT_TRUE(squares.est.optimize().converged);
  EXPECT_GT((*squares.line - inliers).norm(), 1);
  EXPECT_TRUE(plain.est.optimize().converged);
  EXPECT_GT((*plain.line - inliers).norm(), 1) << "it stays with the outliers, where it started";
  for (const std::string algorithm : {"Gauss-Newton", "Levenberg-Marquardt", "dog leg"}) {
    LineFit fit(bad_start, points, slom::GemanMcClure(3));
    if (algorithm == "Levenberg-Marquardt") fit.est.changeAlgorithm(slom::LevenbergMarquardt());
    if (algorithm == "dog leg") fit.est.changeAlgorithm(slom::DogLeg());
    const slom::Summary summary = fit.est.optimize(graduated());
    EXPECT_TRUE(summary.converged) << algorithm << summary.message;
    // The inliers' standard deviations are 0.025 and 0.015.
    EXPECT_LT((*fit.line - inliers).norm(), 0.01) << algorithm << fit.line->transpose();
    EXPECT_LT(summary.final_rss, plain.est.getRSS());
    const Vector2d fixed_point =
        reweightedLine(*fit.line, points, 3, [](Real t) -> Real { return 1 / ((1 + t) * (1 + t)); });
    EXPECT_LT((*fit.line - fixed_point).norm(), 1e-6);
  }
}

TEST(Graduation, WorksForEveryLoss) {
  const std::vector<Point> points = linePoints(25);
  for (const slom::Loss& loss :
       {slom::Loss(slom::Huber(1.345)), slom::Loss(slom::PseudoHuber(1)), slom::Loss(slom::Cauchy(1)),
        slom::Loss(slom::Tukey(4.685)), slom::Loss(slom::Barron(-4, 2)), slom::Loss(slom::Barron(2, 1))}) {
    LineFit fit(Vector2d(-300, 90), points, loss), near(Vector2d(1, 2), points, loss);
    const slom::Summary summary = fit.est.optimize(graduated());
    near.est.optimize();
    EXPECT_TRUE(summary.converged) << loss.text() << summary.message;
    EXPECT_LT((*fit.line - *near.line).norm(), 1e-5) << loss.text();
  }
}

TEST(Graduation, RegistersPointsOfWhichHalfAreWrong) {
  typedef mtk::trafo<mtk::SO3<>> Pose;
  std::mt19937 rng(9);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> place(-5, 5);
  const Pose truth(mtk::SO3<>::exp(mtk::vect<3>(0.9, -1.4, 0.6)), mtk::vect<3>(1, -2, 3));
  slom::Estimator est;
  const auto pose = est.insertRV(Pose(), "pose");
  for (int i = 0; i < 80; ++i) {
    const mtk::vect<3> p{place(rng), place(rng), place(rng)};
    mtk::vect<3> z = truth * p;
    for (int k = 0; k < 3; ++k) z[k] = i % 2 == 0 ? z[k] + noise(rng) : 2 + place(rng);
    est.insertMeasurement(
        [](const Pose& T, const mtk::vect<3>& a, const mtk::vect<3>& b) { return T * a - b; }, pose, p, z,
        slom::StandardDeviation(0.01), slom::GemanMcClure(4));
  }
  const slom::Summary plain = est.optimize();
  EXPECT_GT(mtk::difference(*pose, truth).norm(), 0.1) << "the start is a bad one";
  est.reinitRV(pose, Pose());
  const slom::Summary summary = est.optimize(graduated());
  EXPECT_TRUE(summary.converged) << summary.message;
  EXPECT_LT(mtk::difference(*pose, truth).norm(), 0.01) << summary;
  EXPECT_EQ(summary.groups[0].losses[0].down_weighted, 40);
  EXPECT_LT(summary.final_rss, plain.final_rss);
}

TEST(Graduation, TellsItsStages) {
  LineFit fit(Vector2d(14, -4), linePoints(40), slom::GemanMcClure(3));
  std::ostringstream table;
  slom::Options options = graduated();
  options.observer = slom::progressTable(table);
  const double before = fit.est.getRSS();
  const slom::Summary summary = fit.est.optimize(options);
  EXPECT_EQ(summary.initial_rss, before);
  EXPECT_EQ(summary.final_rss, fit.est.getRSS());
  EXPECT_EQ(summary.final_rss, summary.trace.back().rss);
  EXPECT_EQ(summary.trace.front().graduation, 1);
  EXPECT_EQ(summary.trace.back().graduation, 1);
  EXPECT_EQ(static_cast<int>(summary.trace.size()), summary.iterations + 1);
  int stages = 1;
  for (std::size_t i = 2; i < summary.trace.size(); ++i) {
    const slom::IterationRecord &last = summary.trace[i - 1], &line = summary.trace[i];
    EXPECT_LE(line.graduation, last.graduation);
    if (line.graduation == last.graduation) {
      EXPECT_LE(line.rss, last.rss * (1 + 1e-9)) << i;
    } else {
      ++stages;
      EXPECT_TRUE(line.graduation == 1 || line.graduation < last.graduation / 1.399) << i;
    }
  }
  EXPECT_EQ(summary.stages, stages);
  EXPECT_GT(stages, 15);
  EXPECT_NE(slom::report(summary).find(
                "\n  graduated non-convexity, stages begun: " + std::to_string(stages) + "\n"),
            std::string::npos);
  EXPECT_NE(table.str().find(", mu = "), std::string::npos);
  // The first mu is 2 max |W r|^2 / c^2 of the start.
  const double largest = LineFit(Vector2d(14, -4), linePoints(40)).est.residuals().cwiseAbs2().maxCoeff();
  EXPECT_NEAR(summary.trace[1].graduation, 2 * largest / 9, 1e-9 * largest);
}

TEST(Graduation, IsOneStageWhereEveryResidualIsSmall) {
  LineFit fit(Vector2d(1, 2), linePoints(0), slom::Cauchy(30)),
      plain(Vector2d(1, 2), linePoints(0), slom::Cauchy(30));
  const slom::Summary summary = fit.est.optimize(graduated());
  EXPECT_EQ(summary.stages, 1);
  EXPECT_EQ(summary.final_rss, plain.est.optimize().final_rss);
  EXPECT_EQ(*fit.line, *plain.line);
}

TEST(Graduation, WithoutLossesIsAWarning) {
  LineFit fit(Vector2d(0, 0), linePoints(5)), plain(Vector2d(0, 0), linePoints(5));
  const slom::Summary summary = fit.est.optimize(graduated());
  ASSERT_EQ(summary.warnings.size(), 2u);
  EXPECT_EQ(summary.warnings[0],
            "graduated_non_convexity has nothing to graduate, because no measurement has a loss; pass a loss "
            "to insertMeasurement, such as slom::GemanMcClure(3)");
  EXPECT_EQ(summary.warnings[1].rfind("chi-square / dof is 398, where", 0), 0u)
      << "the outliers: " << summary.warnings[1];
  EXPECT_EQ(summary.stages, 0);
  EXPECT_EQ(summary.final_rss, plain.est.optimize().final_rss);
}

TEST(Graduation, ThatReachesTheIterationLimitSaysSoAndReportsTheRobustCost) {
  LineFit fit(Vector2d(14, -4), linePoints(40), slom::GemanMcClure(3));
  slom::Options options = graduated();
  options.max_iterations = 7;
  const slom::Summary summary = fit.est.optimize(options);
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::max_iterations);
  EXPECT_EQ(summary.iterations, 7);
  EXPECT_EQ(
      summary.message, "iteration limit of 7 reached while the losses were still graduated, mu = " + [&] {
        char text[32];
        std::snprintf(text, sizeof text, "%.6g", summary.trace.back().graduation);
        return std::string(text);
      }() + "; raise max_iterations");
  EXPECT_GT(summary.trace.back().graduation, 1);
  EXPECT_EQ(summary.final_rss, fit.est.getRSS());
  EXPECT_LT(summary.final_rss, 100 * 9.0) << "Geman-McClure's bound with the scale as given";
  options.max_iterations = 0;
  EXPECT_EQ(fit.est.optimize(options).message, "iteration limit of 0 reached");
}

TEST(Graduation, LeavesTheLossesAsTheyWereWhateverHappens) {
  LineFit fit(Vector2d(14, -4), linePoints(40), slom::GemanMcClure(3));
  struct Trouble {};
  slom::Options options = graduated();
  options.observer = [](const slom::IterationRecord& line) {
    if (line.iteration == 3) throw Trouble();
  };
  EXPECT_THROW(fit.est.optimize(options), Trouble);
  EXPECT_LT(fit.est.getRSS(), 900);
  LineFit same(*fit.line, linePoints(40), slom::GemanMcClure(3));
  EXPECT_EQ(fit.est.getRSS(), same.est.getRSS());
  EXPECT_EQ(fit.est.optimizeStep(), same.est.optimizeStep());
  EXPECT_EQ(*fit.line, *same.line);
}

TEST(Graduation, StopsWhereTheRankIsMissing) {
  slom::Estimator est;
  const auto a = est.insertRV(1.0, "a"), b = est.insertRV(30.0, "b");
  est.insertMeasurement([](double x, double y) { return y - x; }, a, b, slom::GemanMcClure(1));
  const double before = est.getRSS();
  const slom::Summary summary = est.optimize(graduated());
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient);
  EXPECT_EQ(summary.message.substr(0, 59), "[slom.rank-deficient] the measurements do not determine b: ");
  EXPECT_EQ(summary.stages, 1);
  EXPECT_EQ(summary.final_rss, before);
  EXPECT_EQ(*b, 30);
  est.changeAlgorithm(slom::LevenbergMarquardt());
  EXPECT_TRUE(est.optimize(graduated()).converged);
  EXPECT_NEAR(*b, *a, 1e-6);
}

TEST(Graduation, FallsBackFromGaussNewtonWithinItsStages) {
  // The classical divergence of Newton's method, with an outlier.
  slom::Estimator est;
  const auto x = est.insertRV(3.0);
  for (int i = 0; i < 3; ++i)
    est.insertMeasurement([](double v) { return std::atan(v); }, x, slom::Cauchy(1));
  est.insertMeasurement([](double v) { return v - 60; }, x, slom::StandardDeviation(10), slom::Cauchy(1));
  const slom::Summary summary = est.optimize(graduated());
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_EQ(summary.final_rss, est.getRSS());
}

TEST(Graduation, WarnsWhenItEndsAboveTheStart) {
  // Three equal measurements, where the fit starts, and five scattered ones on one side that draw it away.
  slom::Estimator est;
  const auto x = est.insertRV(0.0);
  for (const double z : {0.0, 0.0, 0.0, 10.0, 11.5, 13.0, 14.5, 16.0}) {
    est.insertMeasurement([](double v, double datum) { return v - datum; }, x, z, slom::GemanMcClure(1));
  }
  const slom::Summary summary = est.optimize(graduated());
  ASSERT_GT(summary.final_rss, summary.initial_rss) << *x;
  char expected[200];
  std::snprintf(
      expected, sizeof expected,
      "graduated non-convexity ended at the RSS %g, above the RSS of the start, %g; if the start was good, "
      "fit from it without graduated_non_convexity",
      summary.final_rss, summary.initial_rss);
  EXPECT_EQ(summary.warnings, std::vector<std::string>{expected});
}

TEST(Graduation, RefusesBadOptions) {
  const auto message = [](double factor, int iterations) {
    slom::Options options;
    options.graduation_factor = factor;
    options.stage_iterations = iterations;
    return messageOf([&] { slom::Estimator().optimize(options); });
  };
  EXPECT_EQ(message(1, 2),
            "[slom.bad-option] graduation_factor is 1; pass a finite number above 1, such as 1.4");
  EXPECT_EQ(message(1.4, 0), "[slom.bad-option] stage_iterations is 0; pass a positive number, such as 2");
}

}  // namespace
