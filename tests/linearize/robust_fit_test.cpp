// Losses in the fit: the input of the solver, the end of the fit, the tables and the report.
#include <algorithm>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "support/message_of.hpp"
#include "support/robust_line.hpp"

namespace {

using namespace slom::testing;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

const std::vector<slom::Loss> kAll{slom::Huber(1.345),  slom::PseudoHuber(1.2), slom::Cauchy(2.385),
                                   slom::Tukey(4.685),  slom::GemanMcClure(3),  slom::Barron(0.5, 2),
                                   slom::Barron(-5, 2), slom::Barron(1.7, 1),   slom::Barron(2, 1)};

SLOM_BUILD_MEASUREMENT(Position, 3, ((mtk::vect<2>, p))((double, height)), ((Eigen::Vector3d, z)))
SLOM_IMPLEMENT_MEASUREMENT(Position, ret) {
  ret << (*p)[0] * (*p)[1], (*p)[1] + *height, 2 * *height;
  ret -= z;
}

/// Residuals of three components with full covariances, from small to large, every third without a loss. The dense
/// solver solves them, because its system can be inspected.
struct Mixed {
  slom::Estimator est;
  slom::DenseQR* solver;
  slom::VarID<mtk::vect<2>> p = est.insertRV(mtk::vect<2>(0.7, -1.2), "p");
  slom::VarID<double> height = est.insertRV(0.4, "height");
  std::vector<slom::MeasID<Position>> ids;

  explicit Mixed(const slom::Loss& loss) {
    auto dense = std::make_unique<slom::DenseQR>();
    solver = dense.get();
    est.changeSolver(std::move(dense));
    Eigen::Matrix3d L;
    L << 0.5, 0, 0, 0.2, 0.7, 0, -0.1, 0.3, 1.1;
    for (int i = 0; i < 12; ++i) {
      const Vector3d z(-0.84 + 0.3 * i, -0.8 - 0.05 * i * i, 0.8 + 0.2 * (i % 3));
      const slom::StandardDeviation noise(L);
      ids.push_back(i % 3 == 2 ? est.insertMeasurement(Position(p, height, z), noise)
                               : est.insertMeasurement(Position(p, height, z), noise, loss));
    }
  }
  double rssAt(const Vector3d& d) {
    const mtk::vect<2> p0 = *p;
    const double h0 = *height;
    est.reinitRV(p, mtk::vect<2>(p0[0] + d[0], p0[1] + d[1]));
    est.reinitRV(height, h0 + d[2]);
    const double rss = est.getRSS();
    est.reinitRV(p, p0);
    est.reinitRV(height, h0);
    return rss;
  }
};

TEST(NormalEquations, HaveHalfTheGradientOfTheRobustCost) {
  for (const slom::Loss& loss : kAll) {
    Mixed problem(loss);
    problem.est.covariance(problem.p);  // linearises
    const VectorXd g = problem.solver->gradient();
    ASSERT_EQ(g.size(), 3);
    const double h = 1e-4;
    for (int k = 0; k < 3; ++k) {
      const auto rss = [&](double by) { return problem.rssAt(by * Vector3d::Unit(k)); };
      const double slope = (8 * (rss(h) - rss(-h)) - (rss(2 * h) - rss(-2 * h))) / (12 * h);
      EXPECT_NEAR(g[k], slope / 2, 1e-8 * (1 + std::abs(slope))) << loss.text() << " component " << k;
    }
  }
}

TEST(NormalEquations, HaveHalfTheHessianWhereTheLossIsBent) {
  // A linear measurement with |W r| below the scale, so that the second-order correction applies in full.
  for (const slom::Loss& loss :
       {slom::Loss(slom::PseudoHuber(1)), slom::Loss(slom::Cauchy(2)), slom::Loss(slom::Tukey(4)),
        slom::Loss(slom::GemanMcClure(3)), slom::Loss(slom::Barron(-1, 2))}) {
    slom::Estimator est;
    auto dense = std::make_unique<slom::DenseQR>();
    const slom::DenseQR& solver = *dense;
    est.changeSolver(std::move(dense));
    const auto x = est.insertRV(Vector2d(0.7, -0.5));
    est.insertMeasurement([](const Vector2d& v) { return Vector3d(v[0], 2 * v[1], v[0] + v[1]); }, x, loss);
    est.covariance(x);
    const double h = 1e-3;
    const auto rss = [&](double a, double b) {
      const Vector2d centre = *x;
      est.reinitRV(x, centre + Vector2d(a, b));
      const double result = est.getRSS();
      est.reinitRV(x, centre);
      return result;
    };
    const MatrixXd H = solver.jacobian().transpose() * solver.jacobian();
    const double xx = (rss(h, 0) - 2 * rss(0, 0) + rss(-h, 0)) / (h * h);
    const double yy = (rss(0, h) - 2 * rss(0, 0) + rss(0, -h)) / (h * h);
    const double xy = (rss(h, h) - rss(h, -h) - rss(-h, h) + rss(-h, -h)) / (4 * h * h);
    EXPECT_NEAR(2 * H(0, 0), xx, 1e-5) << loss.text();
    EXPECT_NEAR(2 * H(1, 1), yy, 1e-5) << loss.text();
    EXPECT_NEAR(2 * H(0, 1), xy, 1e-5) << loss.text();
  }
}

TEST(NormalEquations, AreReweightedPlainlyWhereTheCurvatureWouldVanish) {
  // One residual x - 0 with D = 1 + 2 s rho''/rho' on either side of 1/4: Cauchy(1) has D = (1 - s) / (1 + s).
  for (const double x0 : {std::sqrt(0.59), std::sqrt(0.61), 1.5, 40.0}) {
    slom::Estimator est;
    auto dense = std::make_unique<slom::DenseQR>();
    const slom::DenseQR& solver = *dense;
    est.changeSolver(std::move(dense));
    const auto x = est.insertRV(x0);
    est.insertMeasurement([](double v) { return v; }, x, slom::Cauchy(1));
    est.covariance(x);
    const double s = x0 * x0, weight = 1 / (1 + s), D = s < 0.6 ? (1 - s) / (1 + s) : 1;
    EXPECT_NEAR(solver.diagonal()[0], weight * D, 1e-9);
    EXPECT_NEAR(solver.gradient()[0], weight * x0, 1e-9);
    EXPECT_NEAR(solver.residual()[0], x0 * std::sqrt(weight / D), 1e-9);
  }
}

TEST(RobustFit, IsTheFixedPointOfReweightedLeastSquares) {
  struct Case {
    slom::Loss loss;
    Weight weight;
  };
  const std::vector<Case> cases{
      {slom::Huber(1.345), [](Real t) -> Real { return t <= 1 ? 1 : 1 / std::sqrt(t); }},
      {slom::PseudoHuber(1.2), [](Real t) -> Real { return 1 / std::sqrt(1 + t); }},
      {slom::Cauchy(2.385), [](Real t) -> Real { return 1 / (1 + t); }},
      {slom::GemanMcClure(3), [](Real t) -> Real { return 1 / ((1 + t) * (1 + t)); }},
      {slom::Tukey(4.685), [](Real t) -> Real { return t < 1 ? (1 - t) * (1 - t) : 0; }},
      {slom::Barron(0.5, 2), [](Real t) -> Real { return std::pow(1 + t / 1.5L, -0.75L); }},
  };
  const std::vector<Point> points = linePoints(20);
  // Only Gauss-Newton, which does not look at the RSS, reaches the optimum to roundoff. The others take only steps that
  // decrease the RSS. They end where its roundoff hides the difference, at a distance of about 0.025 sqrt(4000 *
  // 1e-16).
  slom::Options options;
  options.fall_back = false;
  options.gradient_tolerance = 0;
  options.decrease_tolerance = 0;
  options.step_tolerance = 1e-12;
  for (const Case& one : cases) {
    const Vector2d expected = reweightedLine(Vector2d(1, 2), points, one.loss.scale(), one.weight);
    for (const std::string algorithm : {"Gauss-Newton", "Levenberg-Marquardt", "dog leg"}) {
      LineFit fit(Vector2d(1.3, 1.8), points, one.loss);
      if (algorithm == "Levenberg-Marquardt") fit.est.changeAlgorithm(slom::LevenbergMarquardt());
      if (algorithm == "dog leg") fit.est.changeAlgorithm(slom::DogLeg());
      const slom::Summary summary = fit.est.optimize(options);
      const std::string where = one.loss.text() + " by " + algorithm + ": " + summary.message;
      EXPECT_TRUE(summary.converged) << where;
      EXPECT_LT((*fit.line - expected).norm(), algorithm == "Gauss-Newton" ? 1e-9 : 2e-8)
          << where << " got " << fit.line->transpose();
    }
  }
}

TEST(RobustFit, GetsMonotonouslyBetterAndConvergesWithDefaultOptions) {
  for (const slom::Loss& loss : kAll) {
    LineFit fit(Vector2d(2, 1), linePoints(20), loss);
    const slom::Summary summary = fit.est.optimize();
    EXPECT_TRUE(summary.converged) << loss.text() << summary.message;
    EXPECT_LT(summary.iterations, 40) << loss.text();
    for (std::size_t i = 1; i < summary.trace.size(); ++i) {
      EXPECT_LE(summary.trace[i].rss, summary.trace[i - 1].rss * (1 + 1e-12))
          << loss.text() << " iteration " << i;
      EXPECT_LE(summary.trace[i].gradient, 1 + 1e-12) << "a cosine";
    }
    EXPECT_EQ(summary.final_rss, fit.est.getRSS()) << loss.text();
    EXPECT_EQ(summary.stages, 0);
  }
}

TEST(RobustFit, GivesTheSameBitsOnAnyNumberOfThreads) {
  std::vector<Vector2d> lines;
  std::vector<double> rss;
  std::vector<Point> points;
  for (unsigned seed = 0; seed < 30; ++seed) {
    for (const Point& p : linePoints(40, seed)) points.push_back(p);
  }
  slom::Options options;
  options.graduated_non_convexity = true;
  for (const int threads : {1, 2, 5}) {
    LineFit fit(Vector2d(14, -4), points, slom::GemanMcClure(3));
    fit.est.setThreads(threads);
    rss.push_back(fit.est.optimize(options).final_rss);
    lines.push_back(*fit.line);
  }
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i], lines[0]);
    EXPECT_EQ(rss[i], rss[0]);
  }
}

TEST(RobustRss, IsTheSameHoweverItIsTakenApart) {
  for (const slom::Loss& loss : kAll) {
    Mixed problem(loss);
    double sum = 0;
    for (std::size_t i = 0; i < problem.ids.size(); ++i) {
      const double s = problem.est.whitenedResidual(problem.ids[i]).squaredNorm();
      const bool has_loss = i % 3 != 2;
      const double rho = has_loss ? loss.evaluate(s).rho : s;
      EXPECT_EQ(problem.est.getRSS(problem.ids[i]), rho) << loss.text();
      EXPECT_EQ(problem.est.weight(problem.ids[i]), has_loss ? loss.evaluate(s).first : 1) << loss.text();
      sum += rho;
    }
    const double all = problem.est.getRSS();
    EXPECT_NEAR(all, sum, 1e-13 * sum);
    EXPECT_NEAR(problem.est.getRSS<Position>(), sum, 1e-13 * sum);
    EXPECT_NEAR(problem.est.getRSS(problem.p), sum, 1e-13 * sum);
    EXPECT_NEAR(problem.est.getRMS(), std::sqrt(sum / 36), 1e-12);
    const slom::Summary summary = problem.est.optimize();
    EXPECT_EQ(summary.initial_rss, all);
    EXPECT_EQ(summary.groups[0].initial_rss, all);
    EXPECT_EQ(summary.groups[0].final_rss, summary.final_rss);
    EXPECT_EQ(summary.final_rss, problem.est.getRSS());
  }
}

TEST(RobustRss, LeavesResidualsAsTheyAre) {
  Mixed robust{slom::Tukey(1)}, plain{slom::Loss()};
  EXPECT_EQ(robust.est.residuals(), plain.est.residuals());
  EXPECT_EQ(robust.est.residual(robust.ids[1]), plain.est.residual(plain.ids[1]));
  EXPECT_LT(robust.est.getRSS(), plain.est.getRSS());
  EXPECT_NEAR(plain.est.getRSS(), plain.est.residuals().squaredNorm(), 1e-12 * plain.est.getRSS());
}

TEST(Insertion, TakesNoiseAndLossInEitherOrder) {
  slom::Estimator est;
  const auto x = est.insertRV(3.0), p_height = est.insertRV(1.0);
  const auto p = est.insertRV(mtk::vect<2>(1, 2));
  const auto f = [](double v, double z) { return v - z; };
  const slom::StandardDeviation noise(0.5);
  const slom::Huber loss(1.5);
  const double expected = slom::Huber(1.5).evaluate(16).rho;
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, 1.0, noise, loss)), expected);
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, 1.0, loss, noise)), expected);
  EXPECT_EQ(est.getRSS(est.registerMeasurement(f, x, 1.0, noise, loss)), expected);
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, 1.0, loss, slom::named("level"), noise)), expected);
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, -1.0, loss)), expected) << "unit covariance";
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, 1.0, noise)), 16);
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, 1.0, noise, slom::Loss())), 16) << "no loss";
  EXPECT_EQ(est.getRSS(est.insertMeasurement(f, x, 1.0, noise, slom::Loss(loss))), expected)
      << "chosen at run time";
  const Position measurement(p, p_height, Vector3d(2, 3, 6));
  EXPECT_EQ(est.getRSS(est.insertMeasurement(measurement, noise, loss)), slom::Huber(1.5).evaluate(64).rho);
  EXPECT_EQ(est.getRSS(est.insertMeasurement(measurement, loss, noise)), slom::Huber(1.5).evaluate(64).rho);
  EXPECT_EQ(est.getRSS(est.insertMeasurement(measurement, loss)), slom::Huber(1.5).evaluate(16).rho);
}

TEST(Insertion, OfABadLossIsNamedAndChangesNothing) {
  slom::Estimator est;
  const auto x = est.insertRV(3.0, "x");
  const auto f = [](double v) { return v; };
  est.insertMeasurement(f, x, slom::StandardDeviation(2));
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto message = [&](const slom::Loss& loss) {
    return messageOf([&] { est.insertMeasurement(f, x, slom::StandardDeviation(3), loss); });
  };
  const std::string remedy = "; pass a positive finite number, in standard deviations of the residual";
  EXPECT_EQ(message(slom::Huber(-1)),
            "[slom.bad-loss] loss Huber(-1) of measurement lambda #2 has scale -1" + remedy);
  EXPECT_EQ(message(slom::Cauchy(0)),
            "[slom.bad-loss] loss Cauchy(0) of measurement lambda #2 has scale 0" + remedy);
  EXPECT_EQ(message(slom::Tukey(nan)),
            "[slom.bad-loss] loss Tukey(nan) of measurement lambda #2 has scale nan" + remedy);
  EXPECT_EQ(message(slom::Barron(1, infinity)),
            "[slom.bad-loss] loss Barron(1, inf) of measurement lambda #2 has scale inf" + remedy);
  EXPECT_EQ(message(slom::PseudoHuber(1e-200)),
            "[slom.bad-loss] loss PseudoHuber(1e-200) of measurement lambda #2 has scale 1e-200" + remedy);
  const std::string shapes =
      "; pass a number up to 2: 2 is least squares, 1 PseudoHuber, 0 Cauchy, -2 GemanMcClure";
  EXPECT_EQ(message(slom::Barron(nan, 1)),
            "[slom.bad-loss] loss Barron(nan, 1) of measurement lambda #2 has shape nan" + shapes);
  EXPECT_EQ(message(slom::Barron(2.5, 1)),
            "[slom.bad-loss] loss Barron(2.5, 1) of measurement lambda #2 has shape 2.5" + shapes);
  EXPECT_EQ(est.getM(), 1);
  EXPECT_EQ(est.getRSS(), 2.25);
  EXPECT_TRUE(est.optimize().groups[0].losses.empty());
  EXPECT_EQ(message(slom::Barron(-infinity, 1)), "no error");
}

TEST(Removal, KeepsTheLossWithItsMeasurement) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  const auto f = [](double v, double z) { return v - z; };
  using Id = decltype(est.insertMeasurement(f, x, 1.0));
  struct Entry {
    Id id;
    double rho;
  };
  std::vector<Entry> entries;
  std::mt19937 rng(11);
  for (int i = 0; i < 3000; ++i) {
    const double z = 1 + i % 17, scale = 1 + 0.01 * (i % 400);
    switch (rng() % 4) {
      case 0:
        entries.push_back({est.insertMeasurement(f, x, z), z * z});
        break;
      case 1:
        entries.push_back(
            {est.insertMeasurement(f, x, z, slom::Huber(2)), slom::Huber(2).evaluate(z * z).rho});
        break;
      case 2:
        entries.push_back(
            {est.insertMeasurement(f, x, z, slom::Cauchy(scale)), slom::Cauchy(scale).evaluate(z * z).rho});
        break;
      default:  // away with an earlier one
        if (entries.size() < 2) break;
        std::swap(entries[rng() % entries.size()], entries.back());
        est.removeMeasurement(entries.back().id);
        entries.pop_back();
    }
    if (i % 500 == 450) {  // long after the last sorting out, when its memory holds other losses
      for (const Entry& entry : entries) ASSERT_EQ(est.getRSS(entry.id), entry.rho) << i;
    }
    if (i % 500 == 499) {  // away with most: what is kept is sorted out
      for (std::size_t keep = 10; entries.size() > keep; entries.pop_back())
        est.removeMeasurement(entries.back().id);
    }
  }
  double sum = 0;
  for (const Entry& entry : entries) {
    EXPECT_EQ(est.getRSS(entry.id), entry.rho);
    sum += entry.rho;
  }
  EXPECT_NEAR(est.getRSS(), sum, 1e-12 * sum);
}

TEST(Removal, OfAllLossesGivesTheBitsOfAFitWithoutThem) {
  const std::vector<Point> points = linePoints(20);
  LineFit plain(Vector2d(3, 0), points), changed(Vector2d(3, 0), points);
  std::vector<slom::MeasID<slom::CallableMeasurement<LineResidual, slom::VarID<Vector2d>, double, double>>>
      robust;
  for (int i = 0; i < 5; ++i) {
    robust.push_back(
        changed.est.insertMeasurement(LineResidual{}, changed.line, 1.0, 1.0 * i, slom::Huber(1)));
  }
  for (auto id = robust.rbegin(); id != robust.rend(); ++id) changed.est.removeMeasurement(*id);
  EXPECT_EQ(changed.est.optimize().final_rss, plain.est.optimize().final_rss);
  EXPECT_EQ(*changed.line, *plain.line);
}

TEST(NotFinite, IsNotHiddenByABoundedLoss) {
  for (const slom::Loss& loss : kAll) {
    slom::Estimator est;
    const auto x = est.insertRV(0.0, "x");
    est.insertMeasurement([](double v) { return 1 / v; }, x, loss);
    est.insertMeasurement([](double v) { return v - 1; }, x);
    EXPECT_TRUE(std::isnan(est.getRSS())) << loss.text();
    EXPECT_EQ(
        messageOf([&] { est.optimize(); }),
        "[slom.not-finite] the residual of measurement lambda #1 is not finite at x = (0); check its data, the "
        "function "
        "where it divides, takes roots or logarithms or leaves an entry of its result unset, and the start values");
  }
}

TEST(Report, SaysWhatTheLossesDid) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  const auto f = [](double v, double z) { return v - z; };
  for (int i = 0; i < 8; ++i) est.insertMeasurement(f, x, i < 6 ? 1.0 : 50.0, slom::Huber(1.345));
  est.insertMeasurement(f, x, 1.0, slom::Barron(-2, 1.5));
  est.insertMeasurement(f, x, 1.0);
  est.insertMeasurement([](double v) { return v - 1; }, x);
  const slom::Summary summary = est.optimize();
  ASSERT_EQ(summary.groups.size(), 2u);
  ASSERT_EQ(summary.groups[0].losses.size(), 2u);
  EXPECT_EQ(summary.groups[0].losses[0].loss, "Huber(1.345)");
  EXPECT_EQ(summary.groups[0].losses[0].measurements, 8);
  EXPECT_EQ(summary.groups[0].losses[0].down_weighted, 2);
  EXPECT_EQ(summary.groups[0].losses[1].measurements, 1);
  EXPECT_TRUE(summary.groups[1].losses.empty());
  EXPECT_TRUE(summary.hasLosses());
  const std::string text = slom::report(summary);
  EXPECT_NE(text.find("\n  lambda: Huber(1.345) on 8 of 10 measurements, 2 down-weighted (weight < 1/2)\n"
                      "  lambda: Barron(-2, 1.5) on 1 of 10 measurements, 0 down-weighted (weight < 1/2)\n"
                      "  robust RSS / dof = "),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("chi-square"), std::string::npos) << text;
}

TEST(Report, SumsUpManyLosses) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  for (int i = 0; i < 6; ++i) {
    est.insertMeasurement([](double v, double z) { return v - z; }, x, i < 5 ? 1.0 : 50.0,
                          slom::Huber(1 + 0.1 * i));
  }
  const std::string text = slom::report(est.optimize());
  EXPECT_NE(text.find("\n  lambda: 6 losses on 6 of 6 measurements, 1 down-weighted (weight < 1/2)\n"),
            std::string::npos)
      << text;
}

TEST(RankDeficiency, ByALossWithoutWeightIsExplained) {
  slom::Estimator est;
  const auto x = est.insertRV(100.0, "x");
  for (int i = 0; i < 3; ++i)
    est.insertMeasurement([](double v, double z) { return v - z; }, x, 0.1 * i, slom::Tukey(4.685));
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient);
  EXPECT_EQ(summary.warnings,
            std::vector<std::string>{
                "the loss Tukey(4.685) gives weight 0 to 3 of 3 measurements lambda, which then "
                "determine nothing; start nearer to the solution, pass a larger scale, or set "
                "Options::graduated_non_convexity"});
  EXPECT_EQ(*x, 100);
  slom::Options options;
  options.graduated_non_convexity = true;  // the remedy
  EXPECT_TRUE(est.optimize(options).converged);
  EXPECT_NEAR(*x, 0.1, 1e-9);
}

TEST(Covariance, IsThatOfTheWeightsInHubersTails) {
  // Three residuals counted in full, two in Huber's tails, where the model has the weight c / |r|.
  slom::Estimator est;
  const auto x = est.insertRV(0.0);
  for (const double z : {0.0, 0.0, 0.0, 10.0, -20.0}) {
    est.insertMeasurement([](double v, double datum) { return v - datum; }, x, z, slom::Huber(2));
  }
  EXPECT_NEAR(est.covariance(x)(0, 0), 1 / (3 + 2.0 / 10 + 2.0 / 20), 1e-9);
}

}  // namespace
