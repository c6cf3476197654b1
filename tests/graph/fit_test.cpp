// Results of the fit, against answers by hand and against an independent RSS.
#include "graph/graph_command.hpp"
#include "graph/oracle.hpp"

namespace slom::app::graph {
namespace {

using testing::fitted;
using testing::fittedGraph;
using testing::parsed;
using testing::possibleDecrease;
using testing::rssOf;
using testing::simulateGraph;
using testing::unit3;

/// Pose 1 from two measurements that contradict each other, the first with information A = (4 2; 2 3) on its
/// position, in the frame that it puts pose 1 into, the second with the identity.
std::string twoMeasurements(const std::string& angle) {
  return "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0.4 0.3 " + angle + "\nEDGE_SE2 0 1 1 0 " + angle +
         " 4 2 0 3 0 1\nEDGE_SE2 0 1 0 1 " + angle + unit3;
}

TEST(GraphFit, NonDiagonalInformationByHand) {
  // p = (A + 1)^-1 (A (1, 0) + (0, 1)) = (10, 7) / 16
  const auto graph = parsed<Pose2>(fittedGraph(twoMeasurements("0")));
  EXPECT_NEAR(graph.poses[1].value.pos[0], 0.625, 1e-12);
  EXPECT_NEAR(graph.poses[1].value.pos[1], 0.4375, 1e-12);
  EXPECT_NEAR(fitted(twoMeasurements("0"))["final_rss"].get<double>(), 1.1875, 1e-12);
}

TEST(GraphFit, InformationIsThatOfTheMeasuredFrameByHand) {
  // Turned by a right angle A is (3 -2; -2 4): p = (13, 2) / 16
  const std::string content = twoMeasurements("1.5707963267948966");
  const auto graph = parsed<Pose2>(fittedGraph(content));
  EXPECT_NEAR(graph.poses[1].value.pos[0], 0.8125, 1e-12);
  EXPECT_NEAR(graph.poses[1].value.pos[1], 0.125, 1e-12);
  EXPECT_NEAR(fitted(content)["final_rss"].get<double>(), 1.6875, 1e-12);
}

TEST(GraphFit, RssIsTheSumOfSquaresWithoutAHalf) {
  // Two edges that differ by 2 along x, with information 3: p in the middle, RSS = 2 * 3 * 1^2
  const std::string content = "EDGE_SE2 0 1 0 0 0 3 0 0 1 0 1\nEDGE_SE2 0 1 2 0 0 3 0 0 1 0 1\n";
  EXPECT_NEAR(fitted(content)["final_rss"].get<double>(), 6, 1e-12);
}

TEST(GraphFit, WithoutNoiseHasNoWarningOfRoundingErrors) {
  // Chains in the plane and in space with edges that the end fits exactly, but for rounding, from starts a little off.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise;
    std::string plane, space;
    for (int i = 0; i < 8; ++i) {
      const std::string id = std::to_string(i), next = std::to_string(i + 1);
      plane += "VERTEX_SE2 " + id + " " + std::to_string(2 * i + 0.1 * noise(random)) + " " +
               std::to_string(0.1 * noise(random)) + " " + std::to_string(0.05 * noise(random)) + "\n";
      space += "VERTEX_SE3:QUAT " + id + " " + std::to_string(2 * i + 0.1 * noise(random)) + " 0 0 0 0 " +
               std::to_string(0.05 * noise(random)) + " 1\n";
      if (i == 7) break;
      plane += "EDGE_SE2 " + id + " " + next + " 2 0 0.1 100 0 0 100 0 100\n";
      space += "EDGE_SE3:QUAT " + id + " " + next +
               " 2 0 0 0 0 0.5 0.5 100 0 0 0 0 0 100 0 0 0 0 100 0 0 0 100 0 0 100 0 100\n";
    }
    for (const std::string& content : {plane, space}) {
      const auto json = fitted(content);
      EXPECT_LT(json["final_rss"].get<double>(), 1e-18);
      for (const auto& warning : json["warnings"])
        EXPECT_EQ(warning.get<std::string>().find("RSS grow"), std::string::npos) << seed << " " << warning;
    }
  }
}

TEST(GraphFit, HuberByHand) {
  // Measured 0, 0 and 10 along x: p = 1/2 balances 2 * 2p against the outlier's constant force 2; 2 p^2 + 2
  // (10 - p) - 1
  std::string content = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0.3 0 0\n";
  for (const char* x : {"0", "0", "10"}) content += std::string("EDGE_SE2 0 1 ") + x + " 0 0" + unit3;
  const auto json = fitted(content, {"--robust", "huber:1.0"});
  EXPECT_NEAR(json["final_rss"].get<double>(), 18.5, 1e-9);
  EXPECT_NEAR(parsed<Pose2>(fittedGraph(content, {"--robust", "huber:1.0"})).poses[1].value.pos[0], 0.5,
              1e-5);
}

TEST(GraphFit, LossesByHand) {
  // One edge between two fixed poses with a residual of 2 along x, s = 4
  const std::string content = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 3 0 0\nFIX 0 1\nEDGE_SE2 0 1 1 0 0" + unit3;
  const std::map<std::string, double> expected{{"huber:1", 3},
                                               {"huber:1.5", 2 * 3 - 2.25},
                                               {"pseudo-huber:1", 2 * (std::sqrt(5) - 1)},
                                               {"cauchy:1", std::log(5)},
                                               {"tukey:3", 3 * (1 - std::pow(5.0 / 9, 3))},
                                               {"geman-mcclure:1", 0.8},
                                               {"barron:-1:1", 6 * (1 - std::pow(1 + 4.0 / 3, -0.5))},
                                               {"barron:-inf:1", 2 * (1 - std::exp(-2))}};
  for (const auto& [loss, rss] : expected) {
    EXPECT_NEAR(fitted(content, {"--robust", loss})["final_rss"].get<double>(), rss, 1e-12) << loss;
  }
}

TEST(GraphFit, Algorithms) {
  const std::string content = toG2o(simulateGraph<Pose2>(8, 0.02, 3));
  const std::map<std::string, std::string> names{
      {"gn", "Gauss-Newton"}, {"lm", "Levenberg-Marquardt"}, {"dogleg", "dog leg"}};
  const double plain = fitted(content)["final_rss"];
  const testing::TemporaryFolder folder;
  for (const auto& [algorithm, name] : names) {
    EXPECT_NEAR(fitted(content, {"--algorithm", algorithm})["final_rss"].get<double>(), plain, 1e-8 * plain)
        << algorithm;
    const std::string output = testing::runIn(folder, content, {"--algorithm", algorithm}).output;
    EXPECT_NE(output.find(name + "\n"), std::string::npos) << output;
  }
}

TEST(GraphFit, SaysWhenGaussNewtonFellBack) {
  const std::string content = toG2o(testing::scrambled(simulateGraph<Pose2>(12, 0.02, 3)));
  const testing::TemporaryFolder folder;
  const std::string output = testing::runIn(folder, content, {"--init", "file"}).output;
  EXPECT_NE(
      output.find("\n  warning: iteration 3: the Gauss-Newton step made the RSS grow; the step was taken "
                  "back, and Levenberg-Marquardt continued from there\n"),
      std::string::npos)
      << output;
}

/// Checks that the RSS of the command is that of the written values, and that moving any number of them does not make
/// it smaller.
template <class Pose>
void expectOptimal(std::vector<std::string> options, bool quaternion) {
  options.insert(options.end(), {"--init", "file"});
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const std::string content = toG2o(simulateGraph<Pose>(9, 0.05, seed));
    const double start = rssOf(parsed<Pose>(content), quaternion);
    const auto json = fitted(content, options);
    const auto graph = parsed<Pose>(fittedGraph(content, options));
    const double rss = json["final_rss"];
    EXPECT_NEAR(json["initial_rss"].template get<double>(), start, 1e-9 * start) << "seed " << seed;
    EXPECT_NEAR(rssOf(graph, quaternion), rss, 1e-9 * rss) << "seed " << seed;
    EXPECT_LT(rss, start) << "seed " << seed;
    EXPECT_LT(possibleDecrease(graph, 1e-5, quaternion), 1e-10) << "seed " << seed;
  }
}
TEST(GraphFit, FindsTheMinimumInThePlane) { expectOptimal<Pose2>({}, false); }
TEST(GraphFit, FindsTheMinimumInSpace) { expectOptimal<Pose3>({}, false); }
TEST(GraphFit, FindsTheMinimumOfTheQuaternionError) {
  expectOptimal<Pose3>({"--rotation-error", "quaternion"}, true);
}
TEST(GraphFit, QuaternionErrorIsTheAngleInThePlane) {
  expectOptimal<Pose2>({"--rotation-error", "quaternion"}, false);
}

TEST(GraphFit, QuaternionsHaveWNotBelowZero) {
  // Turned by 3.3 rad about x the short way round is 2.983 rad; the quaternion of the edge is given with the
  // other sign.
  const std::string content =
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0.99687 0 0 -0.07912\nFIX 0 1\n"
      "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 -1" +
      testing::unit6;
  const double q = 0.99687 / std::hypot(0.99687, 0.07912), angle = 2 * std::atan2(0.99687, 0.07912);
  const auto rss = [&](const char* error) {
    return fitted(content, {"--rotation-error", error})["initial_rss"].get<double>();
  };
  EXPECT_NEAR(rss("quaternion"), q * q, 1e-12);
  EXPECT_NEAR(rss("vector"), angle * angle, 1e-12);
}

TEST(GraphFit, RepairedInformationIsUsable) {
  // Eigenvalues 3, -1, 1: what is left says (x + y) / sqrt(2) of the position with information 3.
  const std::string bad = "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n", good = "EDGE_SE2 0 1 0 0 0 3 0 0 3 0 1\n";
  const auto graph = parsed<Pose2>(fittedGraph(bad + good, {"--repair-information"}));
  EXPECT_NEAR(graph.poses[1].value.pos[0], 0.25, 1e-9);
  EXPECT_NEAR(graph.poses[1].value.pos[1], 0.25, 1e-9);
  const testing::TemporaryFolder folder;
  const auto result = testing::runIn(folder, bad + good, {"--repair-information"});
  EXPECT_NE(result.output.find("\n  repaired: 1 information matrix\n"), std::string::npos) << result.output;
  EXPECT_NE(testing::runIn(folder, bad + bad + good, {"--repair-information"})
                .output.find("\n  repaired: 2 information matrices\n"),
            std::string::npos);
}

TEST(GraphFit, ThreadsDoNotChangeTheResult) {
  const std::string content = toG2o(simulateGraph<Pose3>(100, 0.05, 5));
  const std::string one = fittedGraph(content, {"--threads", "1"});
  EXPECT_EQ(fittedGraph(content, {"--threads", "2"}), one);
  EXPECT_EQ(fitted(content, {"--threads", "1"})["threads"], 1);
}

}  // namespace
}  // namespace slom::app::graph
