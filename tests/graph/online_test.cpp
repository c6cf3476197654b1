// --online: the graph fed pose by pose.
#include <sstream>

#include <slom/io/g2o.hpp>

#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::expectRefused;
using testing::fitted;
using testing::Json;
using testing::runIn;
using testing::scrambled;
using testing::simulateGraph;
using testing::TemporaryFolder;
using testing::unit3;

/// Returns a ring with meaningless values, and its vertices in descending order.
template <class Pose>
std::string shuffledRing(int count, std::uint64_t seed) {
  const std::string text = io::toG2o(scrambled(simulateGraph<Pose>(count, 0.02, seed)));
  std::istringstream lines(text);
  std::string vertices, others;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("VERTEX")) {
      vertices = line + "\n" + vertices;
    } else {
      others += line + "\n";
    }
  }
  return vertices + others;
}

template <class Pose>
void expectTheBatchOptimum() {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const std::string content = shuffledRing<Pose>(230, seed);
    const Json batch = fitted(content), json = fitted(content, {"--online=check"}), online = json["online"];
    EXPECT_EQ(online["updates"], 230);
    ASSERT_EQ(online["trace"].size(), 230u);
    int compared = 0;
    for (int k = 0; k < 230; ++k) {
      const Json& update = online["trace"][std::size_t(k)];
      EXPECT_EQ(update["pose"], 10 + k);
      EXPECT_EQ(update["converged"], true) << update;
      EXPECT_EQ(update["undetermined"], 0) << update;
      EXPECT_GE(online["seconds"]["worst"].get<double>(), update["seconds"].get<double>());
      compared += update["gap"].is_null() ? 0 : 1;
    }
    EXPECT_EQ(compared, 3);  // after 100, 200 and all
    EXPECT_LE(online["largest_gap"].get<double>(), 2e-6);
    EXPECT_NEAR(online["final_rss"].get<double>(), batch["final_rss"].get<double>(),
                2e-6 * batch["final_rss"].get<double>());
    EXPECT_NEAR(json["final_rss"].get<double>(), batch["final_rss"].get<double>(),
                1e-8 * batch["final_rss"].get<double>());
    EXPECT_EQ(json["final_rss"], online["batch_rss"]);
    const Json& seconds = online["seconds"];
    EXPECT_LE(seconds["median"], seconds["p99"]);
    EXPECT_LE(seconds["p99"], seconds["worst"]);
    EXPECT_LE(seconds["worst"], seconds["total"]);
  }
}

TEST(GraphOnline, EndsAtTheBatchOptimumInThePlane) { expectTheBatchOptimum<Pose2>(); }
TEST(GraphOnline, EndsAtTheBatchOptimumInSpace) { expectTheBatchOptimum<Pose3>(); }

TEST(GraphOnline, NeedsNoVertices) {
  const std::string edges = "EDGE_SE2 0 1 1 0 0" + unit3 + "EDGE_SE2 1 2 1 0 0" + unit3 +
                            "EDGE_SE2 0 2 2.3 0 0" + unit3 + "EDGE_SE2_XY 1 7 1 1 1 0 1\n";
  const Json json = fitted(edges, {"--online"});
  EXPECT_NEAR(json["final_rss"].get<double>(), 0.03, 1e-9);  // 0.3 in three equal parts
  EXPECT_EQ(json["online"]["trace"][0]["rss"], 0);
}

/// The map begins at pose 0, which only pose 3 connects with 1 and 2.
TEST(GraphOnline, PosesWaitForWhatConnectsThem) {
  const Json json =
      fitted("EDGE_SE2 1 2 1 0 0" + unit3 + "EDGE_SE2 0 3 5 0 0" + unit3 + "EDGE_SE2 3 2 -2 0 0" + unit3,
             {"--online"});
  std::vector<long> order;
  for (const Json& update : json["online"]["trace"]) {
    order.push_back(update["pose"]);
    EXPECT_EQ(update["undetermined"], 0);
  }
  EXPECT_EQ(order, (std::vector<long>{0, 3, 2, 1}));
  EXPECT_NEAR(json["final_rss"].get<double>(), 0, 1e-12);
}

TEST(GraphOnline, SaysHowItWent) {
  const TemporaryFolder folder;
  const auto result = runIn(
      folder, "EDGE_SE2 0 1 1 0 0" + unit3 + "EDGE_SE2 1 2 1 0 0" + unit3 + "EDGE_SE2 0 2 2.3 0 0" + unit3,
      {"--online"});
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
  for (const char* text :
       {"\n  start: each pose at the end of an edge from earlier poses\n",
        "\n    updates        pose            RSS   steps   moved   linearised   time/ms\n",
        "\n          3           2           0.03       1       2 ", "\n3 updates in ", " ms, 99 % within ",
        "\n  RSS 0.03, of the batch fit 0.03; largest gap RSS / batch RSS - 1: ", ", 1 update compared\n",
        "\nConverged after "}) {
    EXPECT_NE(result.output.find(text), std::string::npos) << text << "\nin\n" << result.output;
  }
}

TEST(GraphOnline, ThePageHasTheMapOverTime) {
  const TemporaryFolder folder;
  const auto result =
      runIn(folder, shuffledRing<Pose2>(150, 7), {"--online", "--quiet", "--plot", "DIR/map.html"});
  ASSERT_EQ(result.errors, "");
  const std::string html = slom::testing::readFile(folder / "map.html");
  const std::string before = "\nconst data = ";
  const std::size_t begin = html.find(before) + before.size();
  const Json data = Json::parse(html.substr(begin, html.find(";\nconst canvas = ") - begin));
  const Json& frames = data["frames"];
  ASSERT_EQ(frames.size(), 75u);  // each second update
  for (std::size_t f = 0; f < frames.size(); ++f) {
    EXPECT_EQ(frames[f]["pose"], 11 + 2 * f);
    EXPECT_EQ(frames[f]["poses"].size(), 3 * 2 * (f + 1));
  }
  const Json &last = frames.back()["poses"], &all = data["poses"];
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_NEAR(last[i].get<double>(), all[i].get<double>(), 100) << i;  // a thousandth of the map
  EXPECT_EQ(frames.back()["landmarks"].size(), data["landmarks"].size());
}

TEST(GraphOnline, EndsInTime) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, shuffledRing<Pose2>(40, 1),
                            {"--online", "--quiet", "--max-seconds", "1e-9", "--json", "-"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors, "slom: the fit failed: time limit of 1e-09 s reached\n");
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["online"]["updates"], 0);
  EXPECT_TRUE(json["online"]["largest_gap"].is_null());
  EXPECT_TRUE(json["online"]["batch_rss"].is_null());
}

TEST(GraphOnline, RefusesOtherWords) {
  const std::string content = "EDGE_SE2 0 1 1 0 0" + unit3;
  expectRefused(content, "--online=all: give --online, or --online=check, which compares with the batch fit",
                {"--online=all"});
  expectRefused(content,
                "--init chordal: has no effect with --online, where each pose starts at the end of an edge "
                "from earlier poses; drop one of the two",
                {"--online", "--init", "chordal"});
}

}  // namespace
}  // namespace slom::app::graph
