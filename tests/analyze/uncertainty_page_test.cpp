// The code of docs/uncertainty.md, docs/intervals.md, docs/shared_errors.md, docs/error_sizes.md and docs/outliers.md: a
// small survey, measured by distances.
// Pages show code of this file as it stands.
// clang-format off
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <slom/analyze/clustered.hpp>
#include <slom/analyze/variance_components.hpp>
#include <slom/plot.hpp>
#include <slom/posterior.hpp>
#include <slom/slom.hpp>

#include "support/documentation.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace {

using vec2 = mtk::vect<2>;
using slom::testing::blocks;

std::string page(const std::string& name = "uncertainty") {
  return slom::testing::readFile(slom::testing::sourcePath("docs/" + name + ".md"));
}

const auto distance = [](const auto& a, const auto& b) { return (a - b).norm(); };

/// Five points, all distances between them but for one, to a centimetre.
struct SurveyOfThePage {
  slom::Estimator est;
  slom::VarID<vec2> church = est.insertRV(vec2(0, 0), "church"), mill = est.insertRV(vec2(100, 0), "mill"),
                    tower = est.insertRV(vec2(60, 80), "tower"), barn = est.insertRV(vec2(-20, 50), "barn"),
                    oak = est.insertRV(vec2(40, 40), "oak");
  SurveyOfThePage() {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal(0, 0.01);
    const std::vector<slom::VarID<vec2>> points{church, mill, tower, barn, oak};
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (i == 3 && j == 1) continue;
        est.insertMeasurement(distance, points[i], points[j], slom::measured(distance(*points[i], *points[j]) + normal(engine)),
                              slom::StandardDeviation(0.01), slom::named("tape"));
      }
    }
  }
};

/// All distances are taken on each of 12 days, on which the tape has another length.
TEST(UncertaintyPage, ErrorsThatMeasurementsShare) {
  slom::Estimator est;
  const auto church = est.insertRV(vec2(0, 0), false, "church"), mill = est.insertRV(vec2(100, 0), "mill"),
             tower = est.insertRV(vec2(60, 80), "tower"), barn = est.insertRV(vec2(-20, 50), "barn"),
             oak = est.insertRV(vec2(40, 40), "oak");
  est.fix(mill, "y");
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0, 1);
  const std::vector<slom::VarID<vec2>> points{church, mill, tower, barn, oak};
  const std::vector<vec2> truth{*church, *mill, *tower, *barn, *oak};
  for (int day = 0; day < 12; ++day) {
    const double stretch = 1 + 3e-4 * normal(engine);
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double length = stretch * distance(truth[i], truth[j]) + 0.01 * normal(engine);
        const auto &a = points[i], &b = points[j];
  est.insertMeasurement(distance, a, b, slom::measured(length), slom::StandardDeviation(0.01),
                        slom::named("tape"), slom::group("day", day));
      }
    }
  }
  const slom::Summary summary = est.optimize();
  ASSERT_TRUE(summary.converged);
  const slom::Clustered c = slom::clustered(est, {.by = {"day"}});
  std::cout << c.report();
  EXPECT_EQ(blocks(page("shared_errors"), "text").at(0), c.report());

  const Eigen::VectorXd half = c.interval(barn, 0.95);       // each component +- half: 95 %, by Student's t
  const Eigen::MatrixXd influence = c.influence(barn);       // days x 2, in standard deviations
  const auto length = est.propagate(distance, c.jointCovariance(mill, barn), mill, barn);
  EXPECT_GT(half[0], 2 * c.standardDeviation(barn)[0]);
  EXPECT_EQ(influence.rows(), 12);
  EXPECT_GT(length.standardDeviation()[0], est.propagate(distance, mill, barn).standardDeviation()[0]);
  EXPECT_EQ(c.outliers().suspects(), 0);

  std::cout << c.outliers();                                 // days that pull at the values more than they should
  slom::Summary with_both = summary;
  c.addTo(with_both);                                        // its report() has a column of clustered ones
  const slom::ProfileInterval scaled = slom::profile(est, barn, "x", c, 0.95);
  EXPECT_NE(with_both.report().find("  standard deviation    clustered      dof\n"), std::string::npos);
  EXPECT_NEAR(scaled.upper - scaled.lower, 2 * half[0], 1e-3 * half[0]);
}

/// Distances by a tape whose zero point is another one on each day, and positions by a receiver.
TEST(UncertaintyPage, HowLargeErrorsAre) {
  slom::Estimator est;
  const std::vector<vec2> truth{vec2(0, 0), vec2(100, 0), vec2(60, 80), vec2(-20, 50), vec2(40, 40)};
  const std::vector<std::string> names{"church", "mill", "tower", "barn", "oak"};
  std::vector<slom::VarID<vec2>> points;
  for (std::size_t i = 0; i < 5; ++i) points.push_back(est.insertRV(truth[i], names[i]));
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0, 1);
  const auto position = [](const auto& point) { return point; };
  for (int day = 0; day < 12; ++day) {
    const double zero = 0.02 * normal(engine);
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        est.insertMeasurement(distance, points[i], points[j], slom::measured(distance(truth[i], truth[j]) + zero + 0.015 * normal(engine)),
                              slom::StandardDeviation(0.01), slom::named("tape"), slom::group("day", day));
      }
      if (day % 3 == 0) {
        const double y = 0.03 * normal(engine), x = 0.03 * normal(engine);
        est.insertMeasurement(position, points[i], slom::measured(vec2(truth[i] + vec2(x, y))),
                              slom::StandardDeviation(0.05), slom::named("receiver"));
      }
    }
  }
  ASSERT_TRUE(est.optimize().converged);
  const slom::VarianceComponents v = slom::varianceComponents(est, {.shared = {{"tape", "day"}}});
  std::cout << v.report();
  EXPECT_EQ(blocks(page("error_sizes"), "text").at(0), v.report());
  const auto [lower, upper] = v.at("receiver").interval(0.95);   // of the factor
  slom::apply(v, est);                                       // stated standard deviations, times the factors
  const slom::Summary with_right_weights = est.optimize();
  EXPECT_LT(lower, 0.6);
  EXPECT_GT(upper, 0.6);
  EXPECT_TRUE(with_right_weights.converged);
}

TEST(UncertaintyPage, Pictures) {
  const auto decay = [](const auto& a, const auto& k, double at) { return a * exp(-k * at); };
  slom::Estimator est;
  const auto size = est.insertRV(1.0, "size"), rate = est.insertRV(1.0, "rate");
  const std::vector<double> t{0, 1, 2, 3}, y{3, 1.5, 0.7, 0.4};
  for (std::size_t i = 0; i < t.size(); ++i)
    est.insertMeasurement(decay, size, rate, t[i], slom::measured(y[i]), slom::StandardDeviation(0.08));
  ASSERT_TRUE(est.optimize().converged);
  const slom::testing::TemporaryFolder folder;
  std::filesystem::current_path(folder.path());
  slom::plot(est, t, y, 0.08, decay, size, rate).save("decay.svg");   // decay(size, rate, t[i]) fits y[i]
  slom::plotResiduals(est).save("residuals.svg");
  EXPECT_TRUE(std::filesystem::exists(folder / "decay.svg") && std::filesystem::exists(folder / "residuals.svg"));
  std::filesystem::current_path(folder.path().parent_path());
}

TEST(UncertaintyPage, Works) {
  SurveyOfThePage survey;
  auto& [est, church, mill, tower, barn, oak] = survey;
  {
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  std::cout << diagnosis;
    EXPECT_EQ(blocks(page(), "text").at(0), diagnosis.text());
  }
  est.fix(church);
  est.fix(mill, "y");
  const slom::Summary summary = est.optimize();
  std::cout << summary.report();
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(blocks(page(), "text").at(1), summary.report().substr(summary.report().find("  parameter")));

  const Eigen::MatrixXd C = est.covariance(tower);           // 2 x 2, in the tangent space of the variable
  const Eigen::MatrixXd between = est.covariance(tower, barn);
  const Eigen::VectorXd deviations = est.standardDeviation(tower);
  const Eigen::MatrixXd R = est.correlation(tower, barn);
  const slom::Marginals all = est.marginals();               // those of all variables at once, by selected inversion
  const Eigen::VectorXd same = all.standardDeviation(tower);
  EXPECT_LT((same - deviations).norm(), 1e-12);
  EXPECT_NEAR(R(0, 1), between(0, 1) / std::sqrt(C(0, 0) * est.covariance(barn)(1, 1)), 1e-12);

  const auto length = est.propagate(distance, mill, barn);   // the distance that nobody measured
  std::cout << length.value << " +- " << length.standardDeviation() << "\n";
  EXPECT_NEAR(length.value, 130, 0.1);

  auto [what_if, ids] = slom::posterior(est, mill, barn);    // copies, and a prior for what is known of them
  const auto& [mill_there, barn_there] = ids;
  what_if.insertMeasurement(distance, mill_there, barn_there, slom::measured(distance(*mill, *barn)),
                            slom::StandardDeviation(0.005));
  const double gain = slom::informationGain(est.jointCovariance(mill, barn),
                                            what_if.jointCovariance(mill_there, barn_there));
  std::cout << est.standardDeviation(barn).transpose() << " -> "
            << what_if.standardDeviation(barn_there).transpose() << ", " << gain << " nats\n";
  std::ostringstream line;
  line << est.standardDeviation(barn).transpose() << " -> "
       << what_if.standardDeviation(barn_there).transpose() << ", " << gain << " nats\n";
  EXPECT_EQ(blocks(page(), "text").at(2), line.str());

  const slom::ProfileInterval interval = slom::profile(est, oak, "x", 0.95);
  EXPECT_LT(interval.lower, interval.value);
  EXPECT_LT(interval.value, interval.upper);
  const slom::IntervalTable table = slom::intervals(est, 0.95);
  std::cout << table << table.markdown() << table.csv();
  EXPECT_EQ(table.rows.size(), 7u);

  est.setSigma(slom::Sigma::estimated);
  EXPECT_GT(est.standardDeviation(tower)[0], 0);
  est.setSigma(slom::Sigma::known);

  est.free(church);
  est.free(mill);
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  const slom::Summary network = est.optimize();
  EXPECT_EQ(network.free_directions, 3);
  EXPECT_GT(est.standardDeviation(church)[0], 0);
  est.setFreeGauge(slom::FreeGauge::error);
  est.fix(church);
  est.fix(mill, "y");

  est.bound(mill, "x", 99, 101);
  const auto known = est.prior(barn, vec2(-20, 50), 0.5);    // standard deviation 0.5
  est.removeMeasurement(known);
  est.free(mill);

  est.fix(mill, "y");
  const slom::OutlierReport report = slom::outliers(est);
  std::cout << report;
  EXPECT_EQ(report.suspects(), 0);
  const std::vector<slom::MeasurementCheck> ranking = report.ranking();   // the least probable first
  if (ranking.front().is_suspect) est.removeMeasurement(ranking.front().id);

  const slom::Preflight preflight = slom::preflight(est);
  if (!preflight.ok()) std::cout << preflight;
  EXPECT_TRUE(preflight.ok()) << preflight;
}

}  // namespace
