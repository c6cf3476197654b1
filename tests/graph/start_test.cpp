// Start values, and fixed nodes.
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "graph/graph_command.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::app::graph {
namespace {

using testing::fitted;
using testing::fittedGraph;
using testing::randomVector;
using testing::runIn;
using testing::scrambled;
using testing::simulateGraph;
using testing::TemporaryFolder;
using testing::unit3;

std::string withoutVertices(const std::string& content) {
  std::string text;
  for (std::size_t begin = 0; begin < content.size();) {
    const std::size_t end = content.find('\n', begin) + 1;
    const std::string line = content.substr(begin, end - begin);
    if (!line.starts_with("VERTEX")) text += line;
    begin = end;
  }
  return text;
}

template <class Pose>
void expectEveryStartFindsTheTruth() {
  const std::string content = toG2o(scrambled(simulateGraph<Pose>(12, 0, 1)));
  for (const std::string init : {"auto", "odometry", "spanning-tree", "chordal", "build-up"}) {
    EXPECT_LT(fitted(content, {"--init", init})["initial_rss"].template get<double>(), 1e-15) << init;
    EXPECT_LT(fitted(withoutVertices(content), {"--init", init})["initial_rss"].template get<double>(), 1e-15)
        << init;
  }
  EXPECT_LT(fitted(withoutVertices(content))["initial_rss"].template get<double>(), 1e-15);
}
TEST(GraphStart, FindsTheTruthInThePlane) { expectEveryStartFindsTheTruth<Pose2>(); }
TEST(GraphStart, FindsTheTruthInSpace) { expectEveryStartFindsTheTruth<Pose3>(); }

TEST(GraphStart, ChordalRelaxationIsNearTheMinimum) {
  const std::string content = toG2o(scrambled(simulateGraph<Pose3>(40, 0.05, 2)));
  const auto chordal = fitted(content, {"--init", "chordal"}),
             tree = fitted(content, {"--init", "spanning-tree"});
  const double minimum = chordal["final_rss"];
  EXPECT_LT(chordal["initial_rss"].get<double>(), 10 * minimum);
  EXPECT_GT(tree["initial_rss"].get<double>(), 10 * minimum);
  EXPECT_NEAR(tree["final_rss"].get<double>(), minimum, 1e-6 * minimum);
}

TEST(GraphStart, TheLowestRssIsTheDefault) {
  const std::string content = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 3 0 0\nEDGE_SE2 0 1 1 0 0" + unit3;
  EXPECT_NEAR(fitted(content)["initial_rss"].get<double>(), 0, 1e-12);
  EXPECT_NEAR(fitted(content, {"--init", "auto"})["initial_rss"].get<double>(), 0, 1e-12);
  EXPECT_NEAR(fitted(content, {"--init", "file"})["initial_rss"].get<double>(), 4, 1e-12);
  EXPECT_NEAR(fitted(content, {"--init", "spanning-tree"})["initial_rss"].get<double>(), 0, 1e-12);
}

TEST(GraphStart, OdometryIsTheChainEvenWhereThereIsAShortCut) {
  const std::string content =
      "EDGE_SE2 0 1 1 0 0" + unit3 + "EDGE_SE2 1 2 1 0 0" + unit3 + "EDGE_SE2 0 2 5 0 0" + unit3;
  EXPECT_NEAR(fitted(content, {"--init", "odometry"})["initial_rss"].get<double>(), 9, 1e-12);
  EXPECT_NEAR(fitted(content, {"--init", "spanning-tree"})["initial_rss"].get<double>(), 9, 1e-12);
  const std::string weighted = testing::replaced(content, "0 2 5 0 0 1", "0 2 5 0 0 4");
  EXPECT_NEAR(fitted(weighted, {"--init", "odometry"})["initial_rss"].get<double>(), 36, 1e-12);
  EXPECT_NEAR(fitted(weighted, {"--init", "spanning-tree"})["initial_rss"].get<double>(), 9, 1e-12);
}

/// Returns the lines of the report about what is fixed and where the fit starts.
std::string fixedLine(const std::string& content, const std::vector<std::string>& options = {}) {
  const TemporaryFolder folder;
  const std::string output = runIn(folder, content, options).output;
  const std::size_t begin = output.find("  fixed: ");
  return begin == std::string::npos ? output : output.substr(begin, output.find("\n\n", begin) - begin);
}

TEST(GraphStart, SaysWhatIsFixed) {
  const std::vector<std::string> tree{"--init", "spanning-tree"}, file{"--init", "file"};
  const std::string edges = "EDGE_SE2 4 3 1 0 0" + unit3 + "EDGE_SE2 4 5 1 0 0" + unit3;
  EXPECT_EQ(fixedLine(edges, tree),
            "  fixed: pose 3, because there are no lines FIX\n  start: spanning-tree");
  EXPECT_EQ(fixedLine(edges + "FIX 4\n", tree), "  fixed: 1 pose, by lines FIX\n  start: spanning-tree");
  const std::string vertices =
      "VERTEX_SE2 5 1 0 0\nVERTEX_SE2 4 0 0 0\nVERTEX_SE2 3 0 0 0\nVERTEX_XY 9 7 8\n";
  EXPECT_EQ(fixedLine(vertices + edges + "EDGE_SE2_XY 5 9 1 1 1 0 1\n", file),
            "  fixed: pose 5, because there are no lines FIX\n  start: file");
  EXPECT_EQ(fixedLine(vertices + edges + "EDGE_SE2_XY 5 9 1 1 1 0 1\nFIX 3 4\nFIX 9\n", file),
            "  fixed: 2 poses and 1 landmark, by lines FIX\n  start: file");
  EXPECT_EQ(fixedLine(vertices + edges, {"--init", "file", "--hold-parts"}),
            "  fixed: pose 5 and landmark 9, because there are no lines FIX\n  start: file");
  EXPECT_EQ(fixedLine(vertices + edges + "FIX 4\n", {"--init", "file", "--hold-parts"}),
            "  fixed: 1 pose and 1 landmark, by lines FIX and --hold-parts (landmark 9)\n  start: file");
  EXPECT_EQ(fixedLine(edges),
            "  fixed: pose 3, because there are no lines FIX\n  start: odometry, with the lowest RSS among "
            "odometry, "
            "spanning-tree and chordal");
}

TEST(GraphStart, PartsThatNothingConnectsAreFittedSideBySide) {
  std::string content;
  for (const char* pair : {"0 1", "5 6", "8 9"}) {
    for (const char* x : {" 1", " 3"}) content += std::string("EDGE_SE2 ") + pair + x + " 0 0" + unit3;
  }
  EXPECT_NEAR(fitted(content, {"--hold-parts"})["final_rss"].get<double>(), 3 * 2, 1e-12);
  EXPECT_EQ(fixedLine(content, {"--init", "spanning-tree", "--hold-parts"}),
            "  fixed: pose 0 and the first vertex of 2 more parts, because there are no lines FIX\n  start: "
            "spanning-tree");
}

/// A walk through a building of corridors: thousands of poses, few of them seen again, directions that drift.
std::string corridors(int count) {
  std::mt19937_64 random(5);
  std::map<std::pair<int, int>, int> last_at;
  std::string text;
  const auto edge = [&](int i, int j, const Pose2& motion) {
    const Pose2 z = mtk::moved(
        motion, Eigen::Vector3d(randomVector<3>(random, 1).cwiseProduct(mtk::vect<3>(0.05, 0.05, 0.02))));
    text += fmt::format("EDGE_SE2 {} {} {:.17g} {:.17g} {:.17g} 400 0 0 400 0 2500\n", i, j, z.pos[0],
                        z.pos[1], z.orient.angle());
  };
  std::vector<Pose2> poses{Pose2()};
  for (int i = 1; i < count; ++i) {
    const int turn = i % 15 == 0 ? int(random() % 3) - 1 : 0;
    const Pose2 motion(mtk::SO2<>(turn * M_PI / 2), mtk::vect<2>(1, 0));
    poses.push_back(poses.back() * motion);
    edge(i - 1, i, motion);
    const auto here = std::pair(int(std::lround(poses.back().pos[0])), int(std::lround(poses.back().pos[1])));
    const auto [seen, is_new] = last_at.try_emplace(here, i);
    if (!is_new && i - seen->second > 100 && random() % 4 == 0)
      edge(seen->second, i, poses[std::size_t(seen->second)].inverse() * poses.back());
    seen->second = i;
  }
  return text;
}

TEST(GraphStart, LongWaysTakeFewIterationsFromTheDefaultStart) {
  const std::string content = corridors(slom::testing::hasSanitizers() ? 500 : 4000);
  const auto automatic = fitted(content);
  EXPECT_LE(automatic["iterations"].get<int>(), 10);
  const double redundancy = automatic["redundancy"];
  EXPECT_NEAR(automatic["final_rss"].get<double>(), redundancy, 6 * std::sqrt(2 * redundancy));
}

TEST(GraphStart, FixedPosesStayWhereTheyAre) {
  const std::string content =
      "VERTEX_SE2 0 1 2 0\nVERTEX_SE2 1 0 0 0\nVERTEX_SE2 2 5 2 0\nFIX 0 2\n"
      "EDGE_SE2 0 1 1 0 0" +
      unit3 + "EDGE_SE2 1 2 1 0 0" + unit3;
  for (const std::string init : {"auto", "file", "spanning-tree", "chordal", "build-up"}) {
    const auto graph = testing::parsed<Pose2>(fittedGraph(content, {"--init", init}));
    EXPECT_EQ(graph.poses[0].value.pos, (mtk::vect<2>(1, 2)));
    EXPECT_EQ(graph.poses[2].value.pos, (mtk::vect<2>(5, 2)));
    EXPECT_LT(mtk::difference(graph.poses[1].value, Pose2(mtk::vect<2>(3, 2))).norm(), 1e-6) << init;
    EXPECT_TRUE(graph.poses[0].fixed && !graph.poses[1].fixed && graph.poses[2].fixed);
  }
}

}  // namespace
}  // namespace slom::app::graph
