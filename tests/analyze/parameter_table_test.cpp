// The table of parameters of a summary: values of rotations and directions, and omissions.
#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using SE3 = mtk::trafo<mtk::SO3<>>;
using vec3 = mtk::vect<3>;

std::string linesWith(const std::string& text, const std::string& part) {
  std::istringstream lines(text);
  std::string found;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(part) != std::string::npos) found += line + "\n";
  }
  return found;
}

/// A direction on a compass, in degrees: a manifold of a user's own.
struct Heading {
  using scalar = double;
  static constexpr int DOF = 1;
  double degrees = 0;
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) {
    degrees = std::remainder(degrees + scale * d[0], 360);
  }
  void boxminus(mtk::vectview<double, 1> out, const Heading& other) const {
    out[0] = std::remainder(degrees - other.degrees, 360);
  }
  friend std::ostream& operator<<(std::ostream& os, const Heading& x) { return os << x.degrees << " deg"; }
};

TEST(ParameterTable, ShowsManifoldsOfUsersAsTheyAreWritten) {
  slom::Estimator est;
  const auto north = est.insertRV(Heading{170}, "north");
  est.prior(north, Heading{-179}, 2.0);
  const slom::Summary summary = est.optimize();
  ASSERT_EQ(summary.parameters.size(), 1u);
  EXPECT_EQ(linesWith(summary.report(), "  north"), "  north.0         -179 deg                    2\n");
}

TEST(ParameterTable, HasValuesOfRotationsAndDirections) {
  slom::Estimator est;
  const SE3 truth(mtk::SO3<>::exp(vec3(0.1, -0.2, 0.3)), vec3(1, 2, 3));
  const auto pose = est.insertRV(SE3(), "pose");
  const auto heading = est.insertRV(mtk::SO2<>(), "heading");
  const auto down = est.insertRV(mtk::S2<>(0, 0.1, 1), "down");
  est.prior(pose, truth, 0.01);
  est.prior(heading, mtk::SO2<>(-2.5), 0.02);
  est.prior(down, mtk::S2<>(0, 0.6, -0.8), 0.03);
  const slom::Summary summary = est.optimize();
  ASSERT_TRUE(summary.converged) << summary;
  ASSERT_EQ(summary.parameters.size(), 9u);
  EXPECT_NEAR(summary.parameters[3].value, 0.1, 1e-9);
  EXPECT_NEAR(summary.parameters[4].value, -0.2, 1e-9);
  EXPECT_NEAR(summary.parameters[5].value, 0.3, 1e-9);
  EXPECT_NEAR(summary.parameters[6].value, -2.5, 1e-9);
  EXPECT_TRUE(std::isnan(summary.parameters[7].value));
  EXPECT_EQ(summary.parameters[7].text.substr(summary.parameters[7].text.find(' ')), " 0.6 -0.8)");
  EXPECT_TRUE(summary.parameters[8].text.empty());
  const std::string text = summary.report();
  EXPECT_EQ(linesWith(text, "pose.orient"),
            "  pose.orient.x            0.1                 0.01\n"
            "  pose.orient.y           -0.2                 0.01\n"
            "  pose.orient.z            0.3                 0.01\n");
  EXPECT_EQ(linesWith(text, "heading"), "  heading.angle           -2.5                 0.02\n");
  EXPECT_NE(linesWith(text, "down.0").find(" 0.6 -0.8)                 0.03"), std::string::npos) << text;
  EXPECT_EQ(
      linesWith(text, "note: rotations"),
      "  note: rotations are rotation vectors [rad]; their standard deviations describe small turns about "
      "the axes of the rotated frame\n");
}

TEST(ParameterTable, OfPlanesNeedsNoNoteOnRotations) {
  slom::Estimator est;
  est.prior(est.insertRV(mtk::SO2<>(), "heading"), mtk::SO2<>(1), 0.02);
  EXPECT_EQ(linesWith(est.optimize().report(), "rotation"), "");
}

/// a b x + c, fitted to a line: only the product of a and b counts.
TEST(ParameterTable, IsReplacedByWhatNoMeasurementDetermines) {
  slom::Estimator est;
  est.changeAlgorithm(slom::LevenbergMarquardt());
  const auto a = est.insertRV(2.0, "a"), b = est.insertRV(3.0, "b"), c = est.insertRV(3.0, "c");
  for (int x = 0; x < 10; ++x) {
    est.insertMeasurement(
        [](const auto& p, const auto& q, const auto& r, double at, double y) { return p * q * at + r - y; },
        a, b, c, double(x), 5.0 * x + 0.1 * (x % 3), slom::StandardDeviation(0.1));
  }
  slom::Summary summary = est.optimize();
  ASSERT_TRUE(summary.converged) << summary;
  EXPECT_TRUE(summary.parameters.empty());
  ASSERT_EQ(summary.undetermined.size(), 1u) << summary;
  EXPECT_EQ(summary.undetermined[0].find("a and b cannot be told apart: "), 0u) << summary;
  EXPECT_EQ(linesWith(summary.report(), "no standard deviations"),
            "  no standard deviations: " + summary.undetermined[0] + "\n");
  EXPECT_NE(messageOf([&] { est.covariance(c); })
                .find("not all unknowns are determined, so there are no "
                      "covariances: a and b cannot be told apart"),
            std::string::npos);
  est.fix(b);
  summary = est.optimize();
  EXPECT_EQ(summary.parameters.size(), 2u);
  EXPECT_TRUE(summary.undetermined.empty()) << summary;
}

/// Two unknowns with a well measured sum. Their difference is measured poorly: by `share` of the residuals.
TEST(ParameterTable, NamesWhatIsHardlyDetermined) {
  for (const double share : {1e-8, 1e-7, 1e-3}) {
    slom::Estimator est;
    const auto a = est.insertRV(2.0, "a"), b = est.insertRV(3.0, "b");
    const auto line = [](const auto& p, const auto& q, double x, double z) { return p + x * q - z; };
    est.insertMeasurement(line, a, b, 1.0, 4.0, slom::StandardDeviation(1));
    est.insertMeasurement(line, a, b, 1.0 + share, 5.0, slom::StandardDeviation(1));
    const slom::Summary summary = est.optimize();
    ASSERT_TRUE(summary.converged) << summary;
    ASSERT_EQ(summary.parameters.size(), 2u);
    EXPECT_NEAR(summary.parameters[1].standard_deviation * share, std::sqrt(2), 0.01) << summary;
    const std::string note = linesWith(summary.report(), "note: a and b are hardly determined");
    EXPECT_EQ(note.empty(), share > 1e-6) << summary;
  }
}

/// 50 numbers, each measured twice, the odd ones with three times the noise.
struct Many {
  slom::Estimator est;
  std::vector<slom::VarID<double>> ids;
  Many() {
    for (int i = 0; i < 50; ++i) {
      ids.push_back(est.insertRV(0.0, "x" + std::to_string(i)));
      for (const double z : {i - 0.25, i + 0.25}) est.prior(ids.back(), z, i % 2 == 0 ? 1.0 : 3.0);
    }
  }
};

TEST(ParameterTable, SaysHowManyItDoesNotShow) {
  Many many;
  slom::Summary summary = many.est.optimize();
  EXPECT_TRUE(summary.parameters.empty());
  EXPECT_EQ(summary.parameters_not_shown, 50);
  EXPECT_EQ(linesWith(summary.report(), "not shown"), "  50 parameters not shown\n");
  many.est.addParametersTo(summary);
  ASSERT_EQ(summary.parameters.size(), 50u);
  EXPECT_EQ(summary.parameters_not_shown, 0);
  EXPECT_EQ(linesWith(summary.report(), "not shown"), "");
  EXPECT_EQ(linesWith(summary.report(), "  x49 "), "  x49                   49                 2.12\n");
  for (int i = 0; i < 50; ++i) {
    const slom::ParameterSummary& p = summary.parameters[std::size_t(i)];
    EXPECT_EQ(p.name, "x" + std::to_string(i));
    EXPECT_NEAR(p.value, i, 1e-12);
    EXPECT_NEAR(p.standard_deviation, (i % 2 == 0 ? 1 : 3) / std::sqrt(2), 1e-12);
  }
  const std::string before = summary.report();
  many.est.addParametersTo(summary);
  EXPECT_EQ(summary.report(), before) << "the table is there";
}

TEST(ParameterTable, AddedIsThatOfTheFitItself) {
  Many many;
  many.est.setSigma(slom::Sigma::estimated);
  many.est.fix(many.ids[7]);
  many.est.bound(many.ids[8], 0, 7.5);
  slom::Summary whole = many.est.optimize({.most_parameters = 100});
  slom::Summary added = many.est.optimize();
  many.est.addParametersTo(added);
  ASSERT_EQ(whole.parameters.size(), 48u);
  ASSERT_EQ(added.parameters.size(), 48u);
  for (std::size_t i = 0; i < 48; ++i) {
    EXPECT_EQ(added.parameters[i].name, whole.parameters[i].name);
    EXPECT_EQ(added.parameters[i].value, whole.parameters[i].value);
    EXPECT_NEAR(added.parameters[i].standard_deviation, whole.parameters[i].standard_deviation, 1e-12);
  }
}

TEST(ParameterTable, RefusesTheSummaryOfAnotherProblem) {
  Many many;
  slom::Summary summary = many.est.optimize();
  many.est.fix(many.ids[3]);
  EXPECT_EQ(
      messageOf([&] { many.est.addParametersTo(summary); }),
      "[slom.no-parameters] the summary belongs to a fit of 50 unknowns, but there are 49 now; take the "
      "summary of "
      "the last fit");
  EXPECT_TRUE(summary.parameters.empty());
}

TEST(ParameterTable, SaysHowManyCorrelationsItDoesNotShow) {
  slom::Estimator est;
  std::vector<slom::VarID<double>> ids;
  for (int i = 0; i < 6; ++i) ids.push_back(est.insertRV(0.0, "x" + std::to_string(i)));
  for (int i = 1; i < 6; ++i)
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, ids[0], ids[std::size_t(i)],
                          slom::StandardDeviation(0.01));
  est.prior(ids[0], 0, 1);
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.correlations.size(), 5u);
  EXPECT_EQ(summary.correlations_not_shown, 10);  // of 15 pairs
  EXPECT_EQ(linesWith(summary.report(), "not shown"), "  10 further correlations from 0.95 on, not shown\n");
}

TEST(ParameterTable, AnIntervalIsPrinted) {
  std::ostringstream text;
  text << slom::ProfileInterval{39.994839, 39.97, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(text.str(), "39.994839 in [39.97, inf]");
}

}  // namespace
