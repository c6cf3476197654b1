// A summary as JSON, read again by another program.
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#if __has_include(<nlohmann/json.hpp>)
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::json;

slom::Summary fitted() {
  slom::Estimator est;
  const auto line = est.insertRV(mtk::vect<2>(0, 0), "line");
  for (int i = 0; i < 5; ++i) {
    est.insertMeasurement([](const auto& l, double t) { return l[0] + l[1] * t; }, line, double(i),
                          slom::measured(1 + i / 3.0 + 0.1 * (i % 2)), slom::StandardDeviation(0.1),
                          slom::Huber(1.345), slom::named("line"));
  }
  return est.optimize();
}

TEST(SummaryJson, HoldsTheWholeSummary) {
  const slom::Summary s = fitted();
  const Json json = Json::parse(s.json());
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["stop_reason"], slom::toString(s.stop_reason));
  EXPECT_EQ(json["message"], s.message);
  EXPECT_EQ(json["warnings"], Json(s.warnings));
  EXPECT_EQ(json["algorithm"], s.algorithm);
  EXPECT_EQ(json["solver"], s.solver);
  EXPECT_EQ(json["iterations"], s.iterations);
  EXPECT_EQ(json["stages"], s.stages);
  EXPECT_EQ(json["variables"], 1);
  EXPECT_EQ(json["measurements"], 5);
  EXPECT_EQ(json["unknowns"], 2);
  EXPECT_EQ(json["free_directions"], 0);
  EXPECT_EQ(json["redundancy"], 3);
  EXPECT_EQ(json["initial_rss"], s.initial_rss);
  EXPECT_EQ(json["final_rss"], s.final_rss);
  EXPECT_EQ(json["chi2_per_dof"], s.chi2PerDof());
  EXPECT_EQ(json["sigma"], "known");
  EXPECT_EQ(json["seconds"]["total"], s.seconds);
  EXPECT_EQ(json["seconds"]["setup"], s.phases.setup);
  EXPECT_EQ(json["seconds"]["linearize"], s.phases.linearize);
  EXPECT_EQ(json["seconds"]["factorize"], s.phases.factorize);
  EXPECT_EQ(json["seconds"]["solve"], s.phases.solve);
  ASSERT_EQ(json["groups"].size(), 1u);
  EXPECT_EQ(json["groups"][0]["name"], "line");
  EXPECT_EQ(json["groups"][0]["measurements"], 5);
  EXPECT_EQ(json["groups"][0]["final_rss"], s.groups[0].final_rss);
  EXPECT_EQ(json["groups"][0]["derivatives"], "exact");
  EXPECT_EQ(json["groups"][0]["losses"][0]["loss"], "Huber(1.345)");
  EXPECT_EQ(json["groups"][0]["losses"][0]["measurements"], 5);
  ASSERT_EQ(json["parameters"].size(), 2u);
  EXPECT_EQ(json["parameters"][1]["name"], "line.y");
  EXPECT_EQ(json["parameters"][1]["value"], s.parameters[1].value);
  EXPECT_EQ(json["parameters"][1]["std"], s.parameters[1].standard_deviation);
  EXPECT_FALSE(json["parameters"][1].contains("clustered"));
  EXPECT_EQ(json["undetermined"], Json::array());
  EXPECT_EQ(json["parameters_not_shown"], 0);
  ASSERT_EQ(json["trace"].size(), s.trace.size());
  EXPECT_EQ(json["trace"][1]["rss"], s.trace[1].rss);
  EXPECT_EQ(json["trace"][1]["trials"], s.trace[1].trials);
  EXPECT_EQ(s.json().find('\n'), std::string::npos) << "one line";
}

TEST(SummaryJson, NumbersComeBackToTheLastBit) {
  for (const double x : {0.1, 1 / 3.0, 5e-324, 1.7976931348623157e308, 123456789012345678.0, -2.5e-11}) {
    slom::Summary s;
    s.final_rss = x;
    EXPECT_EQ(Json::parse(s.json())["final_rss"].get<double>(), x);
  }
  slom::Summary s;
  s.final_rss = -0.0;
  EXPECT_TRUE(std::signbit(Json::parse(s.json())["final_rss"].get<double>()));
}

TEST(SummaryJson, WhatIsNotANumberIsNull) {
  slom::Summary s;
  s.initial_rss = std::numeric_limits<double>::infinity();
  s.final_rss = std::numeric_limits<double>::quiet_NaN();
  s.groups.emplace_back();
  s.parameters.emplace_back();
  s.parameters[0].value = NAN;
  s.parameters[0].text = "(0 0 1)";
  s.parameters[0].clustered = 0.5;
  s.parameters[0].clustered_dof = 9;
  const Json json = Json::parse(s.json());
  EXPECT_TRUE(json["initial_rss"].is_null());
  EXPECT_TRUE(json["final_rss"].is_null());
  EXPECT_TRUE(json["chi2_per_dof"].is_null());
  EXPECT_TRUE(json["groups"][0]["redundancy"].is_null());
  EXPECT_TRUE(json["parameters"][0]["value"].is_null());
  EXPECT_EQ(json["parameters"][0]["text"], "(0 0 1)");
  EXPECT_EQ(json["parameters"][0]["clustered"], 0.5);
  EXPECT_EQ(json["parameters"][0]["clustered_dof"], 9);
}

TEST(SummaryJson, TextsOfAllKindsAreValid) {
  const auto message = [](const std::string& text) {
    slom::Summary s;
    s.message = text;
    return Json::parse(s.json())["message"].get<std::string>();
  };
  const std::string bad = "\xEF\xBF\xBD";  // U+FFFD
  const std::string control("a\0b\n\t\x1f\"\\/", 9);
  EXPECT_EQ(message(control), control);
  EXPECT_EQ(message("\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x98\x80"), "\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x98\x80");
  EXPECT_EQ(message("\xFFz"), bad + "z");
  EXPECT_EQ(message("z\xC3"), "z" + bad) << "cut off";
  EXPECT_EQ(message("\xC0\xAF"), bad + bad) << "longer than needed";
  EXPECT_EQ(message("\xE0\x9F\xBF"), bad + bad + bad) << "longer than needed";
  EXPECT_EQ(message("\xED\xA0\x80"), bad + bad + bad) << "a surrogate";
  EXPECT_EQ(message("\xF4\x90\x80\x80"), bad + bad + bad + bad) << "beyond U+10FFFF";
}

}  // namespace

#else
TEST(SummaryJson, IsReadByAnotherProgram) {
  GTEST_SKIP() << "nlohmann/json.hpp, which reads JSON, is not installed";
}
#endif
