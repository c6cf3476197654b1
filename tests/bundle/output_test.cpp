// Report, JSON and the fitted scene.
#include "bundle/output/output.hpp"

#include <regex>

#include <slom/io/bal.hpp>

#include "bundle/bundle_command.hpp"
#include "bundle/fit/fit.hpp"
#include "support/run_json.hpp"

namespace slom::app::bundle {
namespace {

using testing::command;
using testing::fitted;
using testing::Json;
using testing::TemporaryFolder;

const testing::RawScene start = testing::perturbed(testing::simulated(4, 30, 0.3, 41), 0.01, 42);

TEST(BundleOutput, HelpOpensWithASampleRun) {
  const auto help = command.run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_TRUE(help.output.starts_with("slom bundle problem.txt")) << help.output;
  for (const std::string option : {"FILE", "--algorithm", "--solver", "--robust", "--threads",
                                   "--max-iterations", "--tolerance", "--output", "--json", "--quiet"}) {
    EXPECT_NE(help.output.find("  " + option), std::string::npos) << option;
  }
}

TEST(BundleOutput, JsonHasAllKeys) {
  const Json json = fitted(start, {"--threads", "2"}).json;
  slom::testing::expectRunJson(json);
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["variables"], 34);
  EXPECT_EQ(json["measurements"], 240);
  EXPECT_EQ(json["unknowns"], 4 * 9 + 30 * 3);
  EXPECT_EQ(json["free_directions"], 7);
  EXPECT_EQ(json["redundancy"], 121);
  EXPECT_DOUBLE_EQ(json["chi2_per_dof"], json["final_rss"].get<double>() / 121);
}

TEST(BundleOutput, ReportSaysWhatMatters) {
  const TemporaryFolder folder;
  const auto result = command.runIn(folder, testing::contentOf(start), command.all_results);
  EXPECT_EQ(result.errors, "");
  EXPECT_TRUE(result.output.starts_with(
      "bundle adjustment, scene.txt\n  4 cameras, 30 points, 120 observations\n"
      "  gauge: 7 directions are free (place, rotation and scale of the whole), held only by damping\n\n"
      "  iteration            RSS   rel. decrease   step/sigma   gradient   algorithm\n          0 "))
      << result.output;
  const Json json = Json::parse(slom::testing::readFile(folder / "result.json"));
  const auto rms = [&](const char* key) { return std::sqrt(json[key].get<double>() / 120); };
  char text[200];
  std::snprintf(text, sizeof text, "  RMS %.6g px before, %.6g px after\n", rms("initial_rss"),
                rms("final_rss"));
  EXPECT_NE(
      result.output.find("\n  240 measurements - 126 unknowns + 7 free directions = redundancy 121\n  RSS "),
      std::string::npos)
      << result.output;
  EXPECT_TRUE(
      result.output.ends_with(text + std::string("\nwritten: fitted.txt\nwritten: fitted.ply\nwritten: "
                                                 "result.json\n")))
      << result.output;
}

TEST(BundleOutput, RmsKnowsNothingOfTheLoss) {
  const TemporaryFolder folder;
  const std::string output =
      command.runIn(folder, testing::contentOf(start), {"--robust", "huber:0.5"}).output;
  char text[100];
  std::snprintf(text, sizeof text, "\n  RMS %.6g px before, ", std::sqrt(testing::sumOfSquares(start) / 120));
  EXPECT_NE(output.find("\n  robust RSS "), std::string::npos) << output;
  EXPECT_NE(output.find(text), std::string::npos) << output;
}

TEST(BundleOutput, JsonOnStandardOutputSendsTheReportToStandardError) {
  const TemporaryFolder folder;
  const auto result = command.runIn(folder, testing::contentOf(start), {"--json", "-"});
  EXPECT_EQ(Json::parse(result.output)["converged"], true);
  EXPECT_TRUE(result.errors.starts_with("bundle adjustment, scene.txt\n")) << result.errors;
}

TEST(BundleOutput, QuietPrintsNothing) {
  const TemporaryFolder folder;
  const auto result = command.runIn(folder, testing::contentOf(start), {"--quiet"});
  EXPECT_EQ(result.output + result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
}

const std::string small =
    "1 2 2\n0 0 1.5 -2\n0 1 3 0.1\n0\n0\n1.5\n1\n2\n-3\n500\n-0.1\n0.01\n0\n1\n2\n0.25\n1e-300\n-7\n";

TEST(BundleOutput, PlyHasPointsAndCameraCentres) {
  // A quarter turn about z, t = (1, 2, -3): the centre is -R^T t = (-2, 1, 3).
  const std::string scene = testing::replaced(small, "0\n0\n1.5\n", "0\n0\n1.5707963267948966\n");
  const std::string ply = toPly(io::parseScene("scene.txt", scene));
  const std::string head =
      "ply\nformat ascii 1.0\ncomment 2 points, then the centres of 1 camera\nelement vertex 3\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
      "0 1 2 170 170 170\n0.25 1e-300 -7 170 170 170\n";
  ASSERT_TRUE(ply.starts_with(head)) << ply;
  double x = 0, y = 0, z = 0;
  int red = 0, green = 0, blue = 0;
  ASSERT_EQ(std::sscanf(ply.c_str() + head.size(), "%lf %lf %lf %d %d %d", &x, &y, &z, &red, &green, &blue),
            6);
  EXPECT_NEAR(x, -2, 1e-15);
  EXPECT_NEAR(y, 1, 1e-15);
  EXPECT_NEAR(z, 3, 1e-15);
  EXPECT_EQ((std::vector<int>{red, green, blue}), (std::vector<int>{230, 40, 40}));
}

TEST(BundleOutput, FilesHoldTheFittedScene) {
  const auto result = fitted(start, {"--output", "DIR/again.bal"});
  // What the rotation vectors of the BAL file round moves the centres, which come last, by their last digit.
  const auto upToCentres = [](const std::string& ply) { return ply.substr(0, ply.rfind(" 170 170 170\n")); };
  EXPECT_EQ(upToCentres(result.ply), upToCentres(toPly(io::parseScene("scene.txt", result.bal))));
  EXPECT_NEAR(testing::sumOfSquares(result.scene), result.json["final_rss"].get<double>(), 1e-9);
  for (std::size_t i = 0; i < start.observations.size(); ++i) {
    EXPECT_EQ(result.scene.observations[i].u, start.observations[i].u);
    EXPECT_EQ(result.scene.observations[i].v, start.observations[i].v);
  }
}

/// Gauss-Newton refuses cameras and points that nothing holds, and names them.
TEST(BundleOutput, MessagesNameCamerasAndPoints) {
  BundleFit fit(io::parseScene("scene.txt", testing::contentOf(start)), FitOptions());
  const Summary summary = fit.optimize(Options());
  EXPECT_EQ(summary.stop_reason, StopReason::rank_deficient);
  const std::regex names("the measurements do not determine (camera|point) [0-9]+[.]");
  EXPECT_TRUE(std::regex_search(summary.message, names)) << summary.message;
}

}  // namespace
}  // namespace slom::app::bundle
