// Report, JSON and the fitted graph.
#include "graph/graph_command.hpp"
#include "support/run_json.hpp"

namespace slom::app::graph {
namespace {

using testing::fitted;
using testing::fittedGraph;
using testing::Json;
using testing::runIn;
using testing::TemporaryFolder;
using testing::unit3;
using testing::unit6;

const std::string loop = "EDGE_SE2 0 1 1 0 1.57" + unit3 + "EDGE_SE2 1 2 1 0 1.57" + unit3 +
                         "EDGE_SE2 2 3 1 0 1.57" + unit3 + "EDGE_SE2 3 0 1.1 0 1.57" + unit3;

TEST(GraphOutput, HelpOpensWithASampleRun) {
  const auto help = testing::runGraph({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_TRUE(help.output.starts_with("slom graph map.g2o")) << help.output;
  for (const std::string option : {"FILE", "--algorithm", "--solver", "--robust", "--threads",
                                   "--max-iterations", "--init", "--rotation-error", "--repair-information",
                                   "--hold-parts", "--output", "--json", "--plot", "--quiet"}) {
    EXPECT_NE(help.output.find("  " + option), std::string::npos) << option;
  }
}

TEST(GraphOutput, JsonHasAllKeys) {
  const Json json = fitted(loop, {"--threads", "2"});
  slom::testing::expectRunJson(json);
  EXPECT_EQ(json["converged"], true);
  EXPECT_TRUE(json["stop_reason"].is_string());
  EXPECT_TRUE(json["solver"].is_string());
  EXPECT_EQ(json["variables"], 3);
  EXPECT_EQ(json["measurements"], 12);
  EXPECT_EQ(json["unknowns"], 9);
  EXPECT_EQ(json["threads"], 2);
  EXPECT_GT(json["peak_memory_mb"], 1);
  EXPECT_EQ(json["trace"].front()["iteration"], 0);
  EXPECT_GE(json["trace"].back()["seconds"], json["trace"].front()["seconds"]);
  EXPECT_GE(json["seconds"]["total"], json["trace"].back()["seconds"]);
}

TEST(GraphOutput, JsonOnStandardOutputSendsTheReportToStandardError) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, loop, {"--json", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(Json::parse(result.output)["converged"], true);
  EXPECT_TRUE(result.errors.starts_with("graph in the plane, map.g2o\n  4 poses, 4 edges\n"))
      << result.errors;
}

TEST(GraphOutput, ReportSaysWhatMatters) {
  const TemporaryFolder folder;
  const auto result =
      runIn(folder, loop + "EDGE_SE2_XY 0 9 1 1 1 0 1\n",
            {"--output", "DIR/fitted.g2o", "--json", "DIR/r.json", "--init", "spanning-tree"});
  EXPECT_EQ(result.errors, "");
  EXPECT_TRUE(result.output.starts_with(
      "graph in the plane, map.g2o\n  4 poses, 4 edges\n  1 landmark, 1 sighting\n"
      "  fixed: pose 0, because there are no lines FIX\n  start: spanning-tree\n\n"
      "  iteration            RSS   rel. decrease   step/sigma   gradient   algorithm\n"
      "          0 "))
      << result.output;
  EXPECT_NE(result.output.find("\nConverged after "), std::string::npos);
  EXPECT_NE(result.output.find("\n  14 measurements - 11 unknowns = redundancy 3\n  RSS "),
            std::string::npos);
  EXPECT_TRUE(result.output.ends_with("\n\nwritten: fitted.g2o\nwritten: r.json\n")) << result.output;
  const auto robust = runIn(folder, loop, {"--robust", "huber:1"});
  EXPECT_NE(robust.output.find("\n  robust RSS "), std::string::npos) << robust.output;
  EXPECT_EQ(robust.output.find("chi2"), std::string::npos) << robust.output;
}

TEST(GraphOutput, NoChiSquareWithoutRedundancy) {
  const TemporaryFolder folder;
  const std::string output = runIn(folder, "EDGE_SE2 0 1 1 0 0" + unit3, {}).output;
  EXPECT_TRUE(output.ends_with("\n  3 measurements - 3 unknowns = redundancy 0\n  RSS 0\n")) << output;
}

TEST(GraphOutput, QuietPrintsNothing) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, loop, {"--quiet"});
  EXPECT_EQ(result.output + result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
}

TEST(GraphOutput, FittedGraphInThePlane) {
  EXPECT_EQ(
      fittedGraph("VERTEX2 3 0 0 0\nVERTEX2 7 0.9 0 0\nVERTEX_XY 9 0 0\nEDGE2 3 7 1 0 0.5 2 0 3 4 0 0\n"
                  "EDGE_SE2_XY 3 9 1 2 1 0.5 1\n",
                  {"--init", "spanning-tree"}),
      "VERTEX_SE2 3 0 0 0\nVERTEX_SE2 7 1 0 0.5\nVERTEX_XY 9 1 2\nFIX 3\nEDGE_SE2 3 7 1 0 0.5 2 0 0 3 0 4\n"
      "EDGE_SE2_XY 3 9 1 2 1 0.5 1\n");
}

TEST(GraphOutput, FittedGraphInSpace) {
  EXPECT_EQ(
      fittedGraph("EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1" + unit6 + "EDGE_SE3_TRACKXYZ 0 7 3 1 1 1 1 0 0 1 0 1\n"),
      "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0 1\n"
      "VERTEX_TRACKXYZ 7 1 1 1\nFIX 0\nEDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1" +
          unit6 + "EDGE_SE3_TRACKXYZ 0 7 0 1 1 1 1 0 0 1 0 1\n");
}

TEST(GraphOutput, AFittedGraphIsAMinimumAlready) {
  const Json json = fitted(fittedGraph(loop));
  EXPECT_NEAR(json["initial_rss"].get<double>(), json["final_rss"].get<double>(), 1e-12);
}

}  // namespace
}  // namespace slom::app::graph
