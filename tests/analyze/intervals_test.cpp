// Intervals: with an estimated variance by Student's t, of all parameters at once, as text, Markdown and CSV.
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>
#include <slom/analyze/chi_square.hpp>
#include <slom/analyze/clustered.hpp>
#include <slom/analyze/student.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using mtk::testing::Random;
using slom::testing::messageOf;

/// A straight line through few points.
struct NoisyLine {
  slom::Estimator est;
  slom::VarID<double> offset = est.insertRV(0.0, "offset"), slope = est.insertRV(0.0, "slope");
  int count;

  NoisyLine(unsigned seed, int points) : count(points) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0, 0.3);
    for (int i = 0; i < points; ++i) {
      est.insertMeasurement([](const auto& a, const auto& b, double x) { return a + b * x; }, offset, slope,
                            double(i), slom::measured(2 + 0.5 * i + noise(engine)),
                            slom::group("half", i / 2));
    }
  }
};

TEST(Intervals, OfALineWithEstimatedVarianceAreStudents) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    NoisyLine line(seed, 3 + static_cast<int>(seed) % 6);
    line.est.setSigma(slom::Sigma::estimated);
    ASSERT_TRUE(line.est.optimize().converged);
    for (const double probability : {0.5, 0.95, 0.999}) {
      const double t = slom::studentCritical(1 - probability, line.count - 2);
      const double half = t * line.est.standardDeviation(line.slope)[0];
      const slom::ProfileInterval interval = slom::profile(line.est, line.slope, probability);
      EXPECT_NEAR(interval.upper, *line.slope + half, 1e-6 * half) << seed << " " << probability;
      EXPECT_NEAR(interval.lower, *line.slope - half, 1e-6 * half) << seed << " " << probability;
    }
  }
}

TEST(Intervals, OfACurveWithEstimatedVarianceEndWhereFSaysSo) {
  // At the ends of the interval (RSS - RSS0) / (RSS0 / dof) = F(1, dof) = t^2, with everything else fitted again. Here
  // this is one other parameter. It is linear, so its best value has a closed formula.
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<double> x, y;
  for (int i = 0; i < 8; ++i) {
    x.push_back(0.4 * i);
    y.push_back(2 * std::exp(-0.8 * x.back()) + noise(engine));
  }
  slom::Estimator est;
  const auto size = est.insertRV(1.0, "size"), rate = est.insertRV(1.0, "rate");
  for (std::size_t i = 0; i < x.size(); ++i) {
    est.insertMeasurement([](const auto& a, const auto& k, double at) { return a * exp(-k * at); }, size,
                          rate, x[i], slom::measured(y[i]));
  }
  est.setSigma(slom::Sigma::estimated);
  ASSERT_TRUE(est.optimize().converged);
  const auto bestRss = [&](double k) {
    double ee = 0, ey = 0, yy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double e = std::exp(-k * x[i]);
      ee += e * e, ey += e * y[i], yy += y[i] * y[i];
    }
    return yy - ey * ey / ee;
  };
  const slom::ProfileInterval interval = slom::profile(est, rate, 0.95);
  const double t = slom::studentCritical(0.05, 6), best = est.getRSS();
  for (const double end : {interval.lower, interval.upper})
    EXPECT_NEAR((bestRss(end) - best) / (best / 6), t * t, 1e-4 * t * t);
  EXPECT_GT(std::abs(interval.upper - *rate) / std::abs(interval.lower - *rate), 1.03);  // not symmetric
}

TEST(Intervals, OfAllParametersAreThoseOfProfile) {
  NoisyLine line(5, 9);
  ASSERT_TRUE(line.est.optimize().converged);
  const slom::IntervalTable table = slom::intervals(line.est, 0.9);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.probability, 0.9);
  const std::vector<slom::VarID<double>> ids{line.offset, line.slope};
  for (std::size_t i = 0; i < 2; ++i) {
    const slom::ProfileInterval own = slom::profile(line.est, ids[i], 0.9);
    EXPECT_EQ(table.rows[i].name, line.est.nameOf(ids[i]));
    EXPECT_EQ(table.rows[i].value, *ids[i]);
    EXPECT_NEAR(table.rows[i].standard_deviation, line.est.standardDeviation(ids[i])[0], 1e-12);
    EXPECT_DOUBLE_EQ(table.rows[i].lower, own.lower);
    EXPECT_DOUBLE_EQ(table.rows[i].upper, own.upper);
    EXPECT_TRUE(table.rows[i].is_profile);
  }
  const slom::Clustered clustered = slom::clustered(line.est);
  const Eigen::VectorXd half = clustered.interval(line.slope, 0.95);
  const slom::IntervalTable wide = slom::intervals(line.est, clustered);
  EXPECT_NEAR(wide.rows[1].upper - *line.slope, half[0], 1e-5 * half[0]);
  EXPECT_GT(wide.rows[0].upper, wide.rows[0].value);
}

TEST(Intervals, AreOneSidedAtBoundsAndFromDeviationsForRotations) {
  slom::Estimator est;
  using Pose = mtk::trafo<mtk::SO3<>>;
  const Pose truth(mtk::SO3<>::exp(mtk::vect<3>(0.3, -0.2, 0.1)), mtk::vect<3>(1, 2, 3));
  const auto pose = est.insertRV(truth, "pose");
  const auto bounded = est.insertRV(0.5, "bounded");
  est.bound(bounded, 0, 1);
  est.prior(pose, truth, slom::StandardDeviation(0.01));
  est.insertMeasurement([](const auto& x) { return x - 2.0; }, bounded, slom::StandardDeviation(0.7));
  ASSERT_TRUE(est.optimize().converged);
  const slom::IntervalTable table = slom::intervals(est);
  ASSERT_EQ(table.rows.size(), 7u);
  for (std::size_t i = 0; i < 6; ++i) {
    const bool is_position = table.rows[i].name.find(".pos.") != std::string::npos;
    EXPECT_EQ(table.rows[i].is_profile, is_position) << table.rows[i].name;
    EXPECT_NEAR(table.rows[i].upper - table.rows[i].value, 1.959963984540054 * 0.01, 1e-8);
    EXPECT_NEAR(table.rows[i].value - table.rows[i].lower, 1.959963984540054 * 0.01, 1e-8);
  }
  EXPECT_EQ(table.rows[6].value, 1);
  EXPECT_EQ(table.rows[6].upper, 1);
  EXPECT_LT(table.rows[6].lower, 1);
  EXPECT_EQ(table.rows[6].standard_deviation, 0);
}

TEST(Intervals, AreWrittenForPagesAndPrograms) {
  slom::IntervalTable table;
  table.probability = 0.95;
  table.rows = {
      {.name = "rate, \"fast\"", .value = 0.25, .standard_deviation = 0.0125, .lower = 0.225, .upper = 0.3},
      {.name = "a|b_c",
       .value = 1234.56789,
       .standard_deviation = 0.01,
       .lower = 1234.54,
       .upper = INFINITY,
       .is_profile = false}};
  EXPECT_EQ(table.csv(),
            "parameter,value,standard_deviation,lower,upper,method\n"
            "\"rate, \"\"fast\"\"\",0.25,0.0125,0.225,0.3,profile\n"
            "a|b_c,1234.56789,0.01,1234.54,inf,standard deviation\n");
  EXPECT_EQ(table.markdown(),
            "| parameter | value | standard deviation | 95 % from | to |\n"
            "| --- | ---: | ---: | ---: | ---: |\n"
            "| rate, \"fast\" | 0.2500 | 0.0125 | 0.2250 | 0.3000 |\n"
            "| a\\|b\\_c \\* | 1234.5679 | 0.01 | 1234.5400 | inf |\n"
            "\n"
            "\\* from the standard deviation; all others by profile likelihood\n");
  EXPECT_EQ(table.text(),
            "95 % intervals\n"
            "  parameter         value  standard deviation      lower   upper\n"
            "  rate, \"fast\"     0.2500              0.0125     0.2250  0.3000\n"
            "  a|b_c *       1234.5679                0.01  1234.5400     inf\n"
            "  * from the standard deviation; all others by profile likelihood\n");
}

TEST(Intervals, SayThatAComponentIsAtItsBound) {
  slom::IntervalTable table;
  table.rows = {{.name = "rate", .value = 0.3, .standard_deviation = 0, .lower = 0.273021, .upper = 0.3}};
  EXPECT_EQ(table.text(),
            "95 % intervals\n"
            "  parameter    value  standard deviation    lower    upper\n"
            "  rate       0.30000            at bound  0.27302  0.30000\n");
}

TEST(Intervals, AreThoseOfAFit) {
  NoisyLine line(5, 9);
  EXPECT_EQ(messageOf([&] { slom::intervals(line.est); }).substr(0, 20), "[slom.not-a-minimum]");
  EXPECT_EQ(messageOf([&] { slom::intervals(line.est, 1.0); }).substr(0, 17), "[slom.bad-option]");
}

/// An offset and an exponential. From the fit on, a large amplitude goes with a small rate; a larger rate is another
/// minimum.
TEST(Intervals, FollowTheMinimumOfTheFit) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Random noise(seed);
    slom::Estimator est;
    est.setThreads(1);
    const auto a = est.insertRV(2.0, "a"), b = est.insertRV(0.8, "b"), c = est.insertRV(0.5, "c");
    const auto curve = [](const auto& p, const auto& q, const auto& r, double t, double y) {
      using std::exp;
      return p * exp(-q * t) + r - y;
    };
    for (int i = 0; i < 25; ++i) {
      const double t = 0.2 * i, y = 2 * std::exp(-0.8 * t) + 0.5 + 0.02 * noise.normal();
      est.insertMeasurement(curve, a, b, c, t, y, slom::StandardDeviation(0.25));
    }
    ASSERT_TRUE(est.optimize().converged);
    const double least = est.getRSS(), rise = slom::chiSquareCritical(0.05, 1);
    const slom::ProfileInterval interval = slom::profile(est, a, 0.95);
    // The best fit of the rest beyond each end, from the rates of both kinds of solutions.
    for (const double end : {interval.lower, interval.upper}) {
      if (!std::isfinite(end)) continue;
      double best = std::numeric_limits<double>::infinity();
      for (const double rate : {0.01, 0.1, 0.8, 3.0}) {
        slom::Estimator other = est.clone();
        other.reinitRV(a, end);
        other.reinitRV(b, rate);
        other.fix(a);
        best = std::min(best, other.optimize().final_rss);
      }
      EXPECT_GT(best - least, 0.98 * rise) << seed << ": " << interval;
    }
  }
}

/// Five heights measured by their differences. The datum is a choice, so only standard deviations exist.
TEST(Intervals, OfAFreeNetworkComeFromStandardDeviations) {
  slom::Estimator est;
  std::vector<slom::VarID<double>> heights;
  for (int i = 0; i < 5; ++i) heights.push_back(est.insertRV(10.0 * i, "h" + std::to_string(i)));
  Random noise(9);
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < i; ++k)
      est.insertMeasurement([](const auto& x, const auto& y, double z) { return y - x - z; },
                            heights[std::size_t(k)], heights[std::size_t(i)],
                            10.0 * (i - k) + 0.1 * noise.normal(), slom::StandardDeviation(0.1));
  }
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  ASSERT_TRUE(est.optimize().converged);
  for (const slom::ParameterInterval& row : slom::intervals(est, 0.95).rows) {
    EXPECT_FALSE(row.is_profile);
    EXPECT_NEAR(row.upper - row.value, 1.959964 * row.standard_deviation, 1e-6);
    EXPECT_NEAR(row.value - row.lower, row.upper - row.value, 1e-9);
  }
  EXPECT_NE(messageOf([&] { slom::profile(est, heights[0], 0.95); }).find("the profile of h0 has no ends"),
            std::string::npos);
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  ASSERT_FALSE(diagnosis.findings.empty());
  EXPECT_FALSE(diagnosis.findings[0].is_fault) << diagnosis;
}

/// A function that rounds, like a simulator that rounds its output.
TEST(Intervals, OfAFunctionThatRoundsNeedItsStepAlone) {
  for (const auto& [digits, step] : {std::pair(1e3, 5e-2), std::pair(1e4, 1e-2), std::pair(1e6, 1e-3)}) {
    Random noise(2);
    slom::Estimator est;
    est.setThreads(1);
    const auto a = est.insertRV(1.0, "a"), b = est.insertRV(0.3, "b"), c = est.insertRV(0.0, "c");
    const auto simulate = [digits = digits](double p, double q, double r, double t) {
      return std::round((p * std::exp(-q * t) + r) * digits) / digits;
    };
    for (int i = 0; i < 25; ++i) {
      const double t = 0.2 * i;
      est.insertMeasurement(slom::numeric(simulate, slom::differences(step)), a, b, c, t,
                            slom::measured(2 * std::exp(-0.8 * t) + 0.5 + 0.02 * noise.normal()),
                            slom::StandardDeviation(0.02));
    }
    const slom::Summary summary = est.optimize();
    ASSERT_TRUE(summary.converged) << summary;
    EXPECT_TRUE(slom::checkDerivatives(est).ok()) << slom::checkDerivatives(est);
    for (const slom::ParameterInterval& row : slom::intervals(est, 0.95).rows) {
      EXPECT_NEAR(row.upper - row.lower, 2 * 1.96 * row.standard_deviation, 0.5 * row.standard_deviation)
          << row.name;
    }
  }
}

}  // namespace
