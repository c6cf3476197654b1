// Tests of residuals: against refits without the measurement, re-simulated data, and published values.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/chi_square.hpp>
#include <slom/slom.hpp>

namespace {

using vec2 = mtk::vect<2>;

TEST(ChiSquare, HasPublishedQuantiles) {
  // NIST/SEMATECH e-Handbook of Statistical Methods, section 1.3.6.7.4: three digits.
  EXPECT_NEAR(slom::chiSquareCritical(0.05, 1), 3.841, 5e-4);
  EXPECT_NEAR(slom::chiSquareCritical(0.001, 10), 29.588, 5e-4);
  EXPECT_NEAR(slom::chiSquareCritical(0.99, 100), 70.065, 5e-4);
  EXPECT_NEAR(slom::chiSquareCritical(0.01, 2), -2 * std::log(0.01), 1e-12);  // exponential for two
  for (const double x : {1e-8, 0.1, 3.0, 50.0, 500.0}) {
    EXPECT_NEAR(slom::chiSquareProbability(x, 1) / std::erfc(std::sqrt(x / 2)), 1, 1e-11) << x;
    EXPECT_NEAR(slom::chiSquareProbability(x, 4) / (std::exp(-x / 2) * (1 + x / 2)), 1, 1e-11) << x;
  }
  EXPECT_EQ(slom::chiSquareProbability(0, 3), 1);
  EXPECT_EQ(slom::chiSquareProbability(INFINITY, 3), 0);
  for (const double p : {1e-12, 0.3, 0.999})
    EXPECT_NEAR(slom::chiSquareProbability(slom::chiSquareCritical(p, 7.5), 7.5) / p, 1, 1e-10);
}

/// A parabola measured in pairs of numbers, so that residuals have two rows.
struct Parabola {
  slom::Estimator est;
  slom::VarID<mtk::vect<3>> c = est.insertRV(mtk::vect<3>(1, 1, 1), "c");
  std::vector<vec2> data;

  static auto predicted(double x) {
    return [x](const auto& a) { return vectorOf(a[0] + a[1] * x + a[2] * x * x, 2 * (a[0] + a[1] * x)); };
  }
  template <class S>
  static mtk::vect<2, S> vectorOf(const S& a, const S& b) {
    return mtk::vect<2, S>(a, b);
  }
  Parabola(unsigned seed, int count, double sigma = 0.1) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal(0, sigma);
    for (int i = 0; i < count; ++i) {
      const double x = 0.3 * i;
      data.push_back(vec2(1 + 2 * x - x * x + normal(engine), 2 + 4 * x + normal(engine)));
    }
  }
  void insert(int without = -1) {
    for (int i = 0; i < static_cast<int>(data.size()); ++i) {
      if (i == without) continue;
      est.insertMeasurement(
          [z = data[std::size_t(i)], x = 0.3 * i](const auto& a) {
            using S = std::decay_t<decltype(a[0] + 0.0)>;
            return vectorOf<S>(a[0] + a[1] * x + a[2] * x * x - z[0], 2 * (a[0] + a[1] * x) - z[1]);
          },
          c, slom::StandardDeviation(0.1), slom::named("sample"));
    }
    EXPECT_TRUE(est.optimize().converged);
  }
};

TEST(Outliers, StatisticAndEffectAreThoseOfLeavingTheMeasurementOut) {
  Parabola all(1, 6);
  all.insert();
  const slom::OutlierReport report = slom::outliers(all.est, {.worst = 100});
  ASSERT_EQ(report.groups.size(), 1u);
  ASSERT_EQ(report.groups[0].worst.size(), 6u);
  EXPECT_NEAR(report.groups[0].redundancy, 12 - 3, 1e-9);
  EXPECT_NEAR(report.groups[0].chi2, all.est.getRSS(), 1e-9);
  for (const slom::MeasurementCheck& check : report.groups[0].worst) {
    Parabola rest(1, 6);
    const int i = std::stoi(check.measurement.substr(check.measurement.find('#') + 1)) - 1;
    rest.insert(i);
    EXPECT_NEAR(check.statistic, all.est.getRSS() - rest.est.getRSS(), 1e-9) << check.measurement;
    EXPECT_EQ(check.dof, 2);
    const Eigen::Vector3d moved = *rest.c - *all.c;
    const Eigen::MatrixXd C = all.est.covariance(all.c);
    EXPECT_NEAR(check.effect, std::sqrt(moved.dot(C.inverse() * moved)), 1e-7) << check.measurement;
    EXPECT_GT(check.redundancy, 0);
    EXPECT_LT(check.redundancy, 1);
  }
}

/// Probabilities of good measurements are uniform, and a whole problem has suspects as rarely as it should.
TEST(Outliers, EffectIsInStandardDeviationsAsSigmaSays) {
  Parabola all(1, 6, 0.3);  // three times as uncertain as stated
  all.insert();
  all.est.setSigma(slom::Sigma::estimated);
  const slom::OutlierReport report = slom::outliers(all.est, {.worst = 100});
  ASSERT_GT(report.variance_factor, 2);
  for (const slom::MeasurementCheck& check : report.groups[0].worst) {
    Parabola rest(1, 6, 0.3);
    rest.insert(std::stoi(check.measurement.substr(check.measurement.find('#') + 1)) - 1);
    const Eigen::Vector3d moved = *rest.c - *all.c;
    const Eigen::MatrixXd C = all.est.covariance(all.c);
    EXPECT_NEAR(check.effect, std::sqrt(moved.dot(C.inverse() * moved)), 1e-7) << check.measurement;
  }
}

TEST(Outliers, AreAsRareAsTheirSignificanceSays) {
  double sum = 0;
  int count = 0, with_suspects = 0;
  constexpr int problems = 400;
  for (unsigned seed = 0; seed < problems; ++seed) {
    Parabola fit(seed + 100, 10);
    fit.insert();
    const slom::OutlierReport report = slom::outliers(fit.est, {.significance = 0.1, .worst = 100});
    with_suspects += report.suspects() > 0 ? 1 : 0;
    for (const slom::MeasurementCheck& check : report.groups[0].worst) {
      sum += check.probability;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0.5, 4 * std::sqrt(1.0 / 12 / count));
  EXPECT_NEAR(with_suspects, 0.1 * problems, 4 * std::sqrt(0.1 * 0.9 * problems));
}

TEST(Outliers, OneWrongDatumInTenThousandIsFound) {
  Parabola fit(5, 10000);
  fit.data[4321][1] += 1;
  fit.insert();
  const slom::OutlierReport report = slom::outliers(fit.est, {.worst = 2});
  EXPECT_EQ(report.suspects(), 1);
  EXPECT_EQ(report.groups[0].worst[0].measurement, "sample #4322");
  EXPECT_TRUE(report.groups[0].worst[0].is_suspect);
  EXPECT_FALSE(report.groups[0].worst[1].is_suspect);
  EXPECT_NE(report.text().find("sample: 10000 measurements, chi-square "), std::string::npos)
      << report.text();
}

TEST(Outliers, KnowOfLossesAndOfWhatNothingChecks) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x"), y = est.insertRV(0.0, "y");
  for (const double z : {0.1, -0.1, 0.05, 50.0}) {
    est.insertMeasurement([z](const auto& v) { return v - z; }, x, slom::Tukey(4.685), slom::named("robust"));
  }
  est.insertMeasurement([](const auto& v) { return v - 3; }, y, slom::named("alone"));
  est.changeAlgorithm(slom::LevenbergMarquardt());
  EXPECT_TRUE(est.optimize().converged);
  const slom::OutlierReport report = slom::outliers(est);
  const slom::MeasurementCheck& wild = report.groups[0].worst[0];
  EXPECT_EQ(wild.measurement, "robust #4");
  EXPECT_EQ(wild.weight, 0);
  EXPECT_TRUE(wild.is_suspect);
  EXPECT_EQ(wild.effect, 0);
  EXPECT_NEAR(wild.redundancy, 1 + est.covariance(x)(0, 0), 1e-9);  // predicted by the others alone
  EXPECT_EQ(report.groups[1].worst[0].dof, 0);
  EXPECT_EQ(report.groups[1].worst[0].probability, 1);
  EXPECT_FALSE(report.groups[1].worst[0].is_suspect);
  EXPECT_NEAR(report.groups[1].redundancy, 0, 1e-12);
}

TEST(Outliers, BadSignificanceIsNamed) {
  Parabola fit(1, 5);
  fit.insert();
  try {
    slom::outliers(fit.est, {.significance = 2});
    FAIL();
  } catch (const mtk::Error& error) {
    EXPECT_STREQ(
        error.what(),
        "[slom.bad-option] the significance of OutlierOptions is 2; pass a probability between 0 and 1, such as 0.01");
  }
}

TEST(Outliers, ASigmaThatIsWrongIsTold) {
  Parabola fit(3, 50, 10.0);
  fit.insert();
  const slom::Diagnosis diagnosis = slom::diagnose(fit.est);
  ASSERT_EQ(diagnosis.findings.size(), 1u);
  EXPECT_EQ(diagnosis.findings[0].kind, slom::Finding::Kind::implausible_sigma);
  double chi2 = 0, factor = 0;
  ASSERT_EQ(
      std::sscanf(
          diagnosis.findings[0].text.c_str(),
          "the residuals of sample contradict its stated uncertainty: chi-square %lg where 97 is expected; if "
          "function and data are right, its standard deviations are %lg times as large as stated",
          &chi2, &factor),
      2)
      << diagnosis.findings[0].text;
  EXPECT_NEAR(chi2, fit.est.getRSS(), 0.01 * chi2);  // written with three digits
  EXPECT_NEAR(factor, std::sqrt(chi2 / 97), 0.01 * factor);
}

}  // namespace
