// Every mistake in the options, starts that cannot be found, fits that fail.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::expectRefused;
using testing::runIn;
using testing::TemporaryFolder;
using testing::unit3;

const std::string graph = "EDGE_SE2 0 1 1 0 0" + unit3 + "EDGE_SE2 1 2 1 0 0" + unit3;

TEST(GraphOptions, NoFile) {
  const auto result = testing::runGraph({});
  EXPECT_EQ(result.errors, "slom: FILE is required; see slom graph --help\n");
  EXPECT_EQ(result.exit_code, 2);
}
TEST(GraphOptions, Names) {
  expectRefused(graph, "--solver lu: unknown solver; give auto, cholesky, cg, qr or dense-qr",
                {"--solver", "lu"});
  expectRefused(graph, "--algorithm newton: unknown algorithm; give gn, lm or dogleg",
                {"--algorithm", "newton"});
  expectRefused(graph,
                "--init random: unknown start; give auto, file, odometry, spanning-tree, chordal or build-up",
                {"--init", "random"});
  expectRefused(graph, "--rotation-error euler: unknown error; give vector or quaternion",
                {"--rotation-error", "euler"});
}
TEST(GraphOptions, Losses) {
  expectRefused(graph,
                "--robust l1:1: unknown loss; give huber, pseudo-huber, cauchy, tukey, geman-mcclure or "
                "barron",
                {"--robust", "l1:1"});
  for (const std::string text :
       {"huber", "huber:", "huber:x", "huber:0", "huber:-1", "huber:nan", "huber:inf", "huber:1:2"}) {
    expectRefused(graph,
                  "--robust " + text +
                      ": write huber:SCALE; SCALE is a positive number of standard "
                      "deviations",
                  {"--robust", text});
  }
  for (const std::string text : {"barron:1", "barron:3:1", "barron:1:0", "barron:1:1:1"}) {
    expectRefused(graph,
                  "--robust " + text +
                      ": write barron:ALPHA:SCALE; ALPHA is not above 2, and SCALE is a positive number of "
                      "standard "
                      "deviations",
                  {"--robust", text});
  }
}
TEST(GraphOptions, Numbers) {
  expectRefused(graph, "--threads -1: give a number from 0 on", {"--threads", "-1"});
  expectRefused(graph, "--max-iterations 0: give a number from 1 on", {"--max-iterations", "0"});
  expectRefused(graph, "Could not convert: --threads = many; see slom graph --help", {"--threads", "many"});
}
TEST(GraphOptions, Plots) {
  for (const std::string name : {"map.png", "map", "map.svg.gz"}) {
    expectRefused(graph,
                  "--plot " + name +
                      ": unknown format; give FILE.svg (a picture) or FILE.html (a page on "
                      "which to turn it)",
                  {"--plot", name});
  }
  expectRefused("EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1" + testing::unit6,
                "--plot map.svg: this graph is in space; give FILE.html, a page to turn it on",
                {"--plot", "DIR/map.svg"});
}
TEST(GraphOptions, OutputsThatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, graph, {"--output", "DIR/no/such.g2o"});
  EXPECT_EQ(result.errors,
            "slom: cannot write no/such.g2o: No such file or directory; name a file in a folder that exists "
            "and may be written\n");
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(runIn(folder, graph, {"--json", "DIR/."}).errors,
            "slom: --json .: this is a folder; give the name of a file\n");
  EXPECT_EQ(runIn(folder, graph, {"--output", "DIR/map.g2o"}).errors,
            "slom: --output map.g2o: this is the file of FILE too; give another one\n");
  EXPECT_EQ(runIn(folder, graph, {"--output", "DIR/a", "--json", "DIR/./a"}).errors,
            "slom: --json ./a: this is the file of --output too; give another one\n");
  EXPECT_EQ(slom::testing::readFile(folder / "map.g2o"), graph);
}
TEST(GraphOptions, StartsThatCannotBeFound) {
  expectRefused(graph,
                "--init file: map.g2o has no vertices; leave the option out, or choose odometry, "
                "spanning-tree, chordal or build-up",
                {"--init", "file"});
  expectRefused(
      graph + "EDGE_SE2 2 7 1 0 0" + unit3,
      "--init odometry: no chain of edges i, i+1 leads from a fixed pose to pose 7 of map.g2o; use --init "
      "spanning-tree",
      {"--init", "odometry"});
  expectRefused(
      graph + "EDGE_SE2_XY 2 7 1 0 1 0 1\nEDGE_SE2_XY 9 7 1 0 1 0 1\n",
      "--init auto: no edge between poses leads to pose 9 of map.g2o, which only landmarks connect with the "
      "rest; add an edge, or add vertices for all");
  expectRefused(
      graph + "EDGE_SE2_XY 2 7 1 0 1 0 1\nEDGE_SE2_XY 9 7 1 0 1 0 1\n",
      "--init build-up: no edge between poses leads to pose 9 of map.g2o, which only landmarks connect with "
      "the rest; add an edge, or add vertices for all",
      {"--init", "build-up"});
}

TEST(GraphOptions, AFitThatDoesNotConvergeSaysSo) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "fitted.g2o", "the old one");
  const auto result = runIn(folder, graph + "EDGE_SE2 2 0 1 0 1" + unit3,
                            {"--max-iterations", "1", "--init", "odometry", "--json", "DIR/result.json",
                             "--output", "DIR/fitted.g2o"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(
      result.errors,
      "slom: the fit failed: iteration limit of 1 reached; raise --max-iterations; --init auto may find a better start\n");
  EXPECT_NE(result.output.find("NOT CONVERGED after 1 iteration: iteration limit reached"),
            std::string::npos);
  EXPECT_NE(result.output.find("\nnot written, because the fit failed: fitted.g2o\nwritten: result.json\n"),
            std::string::npos)
      << result.output;
  EXPECT_EQ(testing::Json::parse(slom::testing::readFile(folder / "result.json"))["converged"], false);
  EXPECT_EQ(slom::testing::readFile(folder / "fitted.g2o"), "the old one");
}

/// A loop of 20 poses with noise, two edges across and one that is measured twice.
std::string noisyLoop() {
  constexpr int n = 20;
  const auto angle = [](int i) { return 2 * std::numbers::pi * i / n; };
  double k = 0;
  const auto noise = [&](double size) {
    ++k;
    return size * std::sin(12.9898 * k * k) * 1.4;
  };
  std::string text;
  for (int i = 0; i < n; ++i)
    text += fmt::format("VERTEX_SE2 {} {:.6f} {:.6f} {:.6f}\n", i, 5 * std::cos(angle(i)),
                        5 * std::sin(angle(i)), angle(i) + std::numbers::pi / 2);
  const auto addEdge = [&](int i, int j) {
    const double heading = angle(i) + std::numbers::pi / 2;
    const double x = 5 * (std::cos(angle(j)) - std::cos(angle(i))),
                 y = 5 * (std::sin(angle(j)) - std::sin(angle(i)));
    const double forward = std::cos(heading) * x + std::sin(heading) * y + noise(0.05);
    const double left = -std::sin(heading) * x + std::cos(heading) * y + noise(0.05);
    const double turn = std::remainder(angle(j) - angle(i), 2 * std::numbers::pi) + noise(0.02);
    text +=
        fmt::format("EDGE_SE2 {} {} {:.6f} {:.6f} {:.6f} 400 0 0 400 0 2500\n", i, j, forward, left, turn);
  };
  for (int i = 0; i < n; ++i) addEdge(i, (i + 1) % n);
  addEdge(0, 10), addEdge(5, 15), addEdge(3, 5);
  return text;
}

/// The default limit is by size, as in the library: losses make small fits take hundreds of cheap iterations.
TEST(GraphOptions, ASmallGraphWithALossGetsTheIterationsItNeeds) {
  const testing::Json json = testing::fitted(noisyLoop(), {"--robust", "huber:0.3"});
  EXPECT_EQ(json["converged"], true);
  EXPECT_GT(json["iterations"], 100);
  const TemporaryFolder folder;
  const auto limited =
      runIn(folder, noisyLoop(), {"--robust", "huber:0.3", "--max-iterations", "100", "--quiet"});
  EXPECT_EQ(limited.errors, "slom: the fit failed: iteration limit of 100 reached; raise --max-iterations\n");
  EXPECT_EQ(limited.exit_code, 1);
}

TEST(GraphOptions, ABetterStartIsProposedOnlyWhereThereIsOne) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, graph + "EDGE_SE2 2 0 1 0 1" + unit3,
                            {"--max-iterations", "1", "--quiet", "--init", "chordal"});
  EXPECT_EQ(result.errors, "slom: the fit failed: iteration limit of 1 reached; raise --max-iterations\n");
  EXPECT_EQ(result.exit_code, 1);
}

TEST(GraphOptions, WhatIsNotDeterminedIsNamed) {
  const TemporaryFolder folder;
  const auto result =
      runIn(folder,
            "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 17 0 0 0\nVERTEX_XY 2 1 0\nEDGE_SE2_XY 0 2 1 0 1 0 1\n"
            "EDGE_SE2_XY 17 2 1 0 1 0 1\n",
            {"--quiet"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("pose 17"), std::string::npos) << result.errors;
  EXPECT_EQ(result.errors.find("chordal"), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace slom::app::graph
