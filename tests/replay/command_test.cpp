// The command on files: its fit is that of the library, and bad input is refused.
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <slom/archive.hpp>
#include <slom/measurements/range.hpp>
#include <slom/measurements/surveying.hpp>

#include "support/command_on_file.hpp"
#include "support/documented_run.hpp"

namespace slom::testing {
namespace {

using Point = mtk::vect<2>;

const CommandOnFile replay{
    "replay", "problem.slom", {"--output", "DIR/fitted.slom", "--json", "DIR/result.json"}};

std::string network() { return readFile(sourcePath("data/saved_problem/network.slom")); }

Archive surveying() {
  Archive archive;
  archive.measurement<Range, VarID<Point>, VarID<Point>, Measured<double>>();
  archive.measurement<HorizontalDirection, VarID<Point>, VarID<Point>, VarID<mtk::SO2<>>,
                      Measured<mtk::SO2<>>>();
  return archive;
}

TEST(Replay, FitsAsTheLibraryDoes) {
  const TemporaryFolder folder;
  const CommandResult result =
      replay.runIn(folder, network(), {"--output", "DIR/fitted.slom", "--json", "DIR/result.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;

  std::istringstream text(network());
  StoredProblem problem = surveying().load(text);
  const Summary summary = problem.estimator.optimize();
  ASSERT_TRUE(summary.converged);
  EXPECT_NE(result.output.find(summary.report().substr(0, summary.report().find("iterations"))),
            std::string::npos)
      << result.output;

  const auto json = nlohmann::json::parse(readFile(folder / "result.json"));
  EXPECT_NEAR(json["final_rss"].get<double>() / summary.final_rss, 1, 1e-9);
  EXPECT_EQ(json["redundancy"], summary.redundancy);
  EXPECT_EQ(json["groups"].size(), 2u);
  EXPECT_EQ(json["groups"][0]["name"], "distance");
  ASSERT_EQ(json["parameters"].size(), summary.parameters.size());
  for (std::size_t i = 0; i < summary.parameters.size(); ++i) {
    EXPECT_EQ(json["parameters"][i]["name"], summary.parameters[i].name);
    EXPECT_NEAR(json["parameters"][i]["std"].get<double>() / summary.parameters[i].standard_deviation, 1,
                1e-6);
  }

  // What it wrote is the fitted problem, within four standard deviations of the truth.
  std::istringstream fitted_text(readFile(folder / "fitted.slom"));
  const StoredProblem fitted = surveying().load(fitted_text);
  EXPECT_NEAR(fitted.estimator.getRSS() / summary.final_rss, 1, 1e-9);
  const Point truth[] = {{180.3, 251.7}, {395.1, 330.4}, {95.6, 402.8}};
  const char* names[] = {"P", "Q", "R"};
  for (int i = 0; i < 3; ++i) {
    const auto id = fitted.variable<Point>(names[i]);
    const Eigen::VectorXd std = fitted.estimator.standardDeviation(id);
    for (int c = 0; c < 2; ++c) EXPECT_LT(std::abs((*id)[c] - truth[i][c]), 4 * std[c]) << names[i];
  }
}

TEST(Replay, OtherAlgorithmsAndSolversFindTheSame) {
  const auto rss = [](const std::vector<std::string>& options) {
    const TemporaryFolder folder;
    std::vector<std::string> all{"--json", "-", "--quiet"};
    all.insert(all.end(), options.begin(), options.end());
    const CommandResult result = replay.runIn(folder, network(), all);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return nlohmann::json::parse(result.output)["final_rss"].get<double>();
  };
  const double expected = rss({});
  for (const char* algorithm : {"lm", "dogleg"})
    EXPECT_NEAR(rss({"--algorithm", algorithm}) / expected, 1, 1e-9);
  for (const char* solver : {"cholesky", "cg", "qr", "dense-qr"})
    EXPECT_NEAR(rss({"--solver", solver}) / expected, 1, 1e-9);
}

TEST(Replay, SaysWhatIsNotDetermined) {
  // Without fixed points the network can move and turn; its scale is that of the distances.
  const TemporaryFolder folder;
  const CommandResult result = replay.runIn(folder, replaced(network(), "fixed", "free"), {"--diagnose"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("can move together (translation x, y; rotation about z)"), std::string::npos)
      << result.output;
}

TEST(Replay, RefusesWhatItCannotRead) {
  replay.expectRefused(
      "", "problem.slom:1: this is not a saved problem: its first line is not \"slom problem 1\"");
  replay.expectRefused(
      replaced(network(), "end\n", ""),
      "problem.slom is not complete: its last line is not \"end\"; take a file that was written to its end");
  replay.expectRefused(
      replaced(network(), "0 2 | scalar 333.33333333333331 | 309.", "0 2 | scalar 333.33333333333331 | x"),
      "problem.slom:15: the text after the second | is not the data of Range(vect<2>, vect<2>, measured "
      "double): x" +
          network().substr(network().find("| 309.") + 6, 4));
}

TEST(Replay, RefusesAnUnknownMeasurementInOneLine) {
  replay.expectRefused(
      replaced(network(), "\"Range(", "\"Echo("),
      "problem.slom:14: slom replay does not know measurements \"Echo(vect<2>, vect<2>, measured double)\"; "
      "fit this file with the program that saved it");
  const TemporaryFolder folder;
  const CommandResult other =
      replay.runIn(folder, replaced(network(), "\"Range(vect<2>, vect<2>", "\"Range(vect<2>, vect<7>"), {});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_TRUE(other.errors.starts_with(
      "slom: problem.slom:14: slom replay does not know measurements \"Range(vect<2>, vect<7>, measured "
      "double)\" but "
      "\"Range(vect<2>, vect<2>, measured double)\", \"Range("))
      << other.errors;
  EXPECT_LT(other.errors.size(), 600u);
}

TEST(Replay, RefusesOptions) {
  replay.expectRefused(network(), "--algorithm newton: unknown algorithm; give gn, lm or dogleg",
                       {"--algorithm", "newton"});
  replay.expectRefused(network(), "--max-iterations 0: give a number from 1 on", {"--max-iterations", "0"});
}

TEST(Replay, ThePageShowsARealRun) { expectRealRun("docs/replay.md"); }

}  // namespace
}  // namespace slom::testing
