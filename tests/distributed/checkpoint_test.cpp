// A fit goes on from a checkpoint, with another number of processes.
#include <filesystem>
#include <random>
#include <regex>
#include <string>

#include <nlohmann/json.hpp>

#include <slom/io/g2o.hpp>

#include "distributed/bundle_text.hpp"
#include "distributed/mpirun.hpp"
#include "io/simulated_graph.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {
namespace {

/// A graph that begins away from its solution.
io::PoseGraph<io::Pose3> movedGraph() {
  std::mt19937_64 random(8);
  io::PoseGraph<io::Pose3> graph = io::testing::simulateGraph<io::Pose3>(40, 0.01, 3);
  for (auto& pose : graph.poses) {
    if (!pose.fixed) pose.value = pose.value * io::testing::randomPose<io::Pose3>(random, 0.5, 0.2);
  }
  return graph;
}

TEST(Checkpoints, GoOnWithAnotherNumberOfProcesses) {
  const TemporaryFolder folder;
  const std::string map = (folder / "map.g2o").string(), state = (folder / "state").string();
  writeFile(folder / "map.g2o", io::toG2o(movedGraph()));
  const auto rssOf = [](const CommandResult& result) {
    return nlohmann::json::parse(result.output)["final_rss"].get<double>();
  };
  const CommandResult whole = runSlom(3, {"graph", map, "--quiet", "--json", "-"});
  ASSERT_EQ(whole.exit_code, 0) << whole.errors;
  const CommandResult cut =
      runSlom(3, {"graph", map, "--quiet", "--json", "-", "--max-iterations", "1", "--checkpoint", state});
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_GT(rssOf(cut), rssOf(whole));
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(state)) ++files;
  EXPECT_EQ(files, 4u);  // one set: values of three processes, and the file that names them
  for (const int processes : {1, 2, 4}) {
    const CommandResult rest =
        runSlom(processes, {"graph", map, "--quiet", "--json", "-", "--resume", state});
    ASSERT_EQ(rest.exit_code, 0) << rest.errors;
    const nlohmann::json json = nlohmann::json::parse(rest.output);
    EXPECT_NEAR(rssOf(rest), rssOf(whole), 1e-10 * rssOf(whole));
    EXPECT_NEAR(json["initial_rss"].get<double>(), rssOf(cut), 1e-10 * rssOf(cut));
  }
}

TEST(Checkpoints, OfOneProcessAreReadBySeveral) {
  const TemporaryFolder folder;
  const std::string map = (folder / "map.g2o").string(), state = (folder / "state").string();
  writeFile(folder / "map.g2o", io::toG2o(movedGraph()));
  const auto jsonOf = [](const CommandResult& result) { return nlohmann::json::parse(result.output); };
  const CommandResult cut =
      runSlom(1, {"graph", map, "--init", "file", "--quiet", "--json", "-", "--max-iterations", "1",
                  "--checkpoint", state, "--checkpoint-minutes", "60"});
  EXPECT_EQ(cut.exit_code, 1);
  for (const int processes : {1, 3}) {
    const CommandResult rest =
        runSlom(processes, {"graph", map, "--quiet", "--json", "-", "--resume", state});
    ASSERT_EQ(rest.exit_code, 0) << rest.errors;
    const double before = jsonOf(cut)["final_rss"];
    EXPECT_NEAR(jsonOf(rest)["initial_rss"].get<double>(), before, 1e-10 * before);
  }
}

TEST(Checkpoints, OfScenesGoOnWithAnotherNumberOfProcesses) {
  const TemporaryFolder folder;
  const std::string file = (folder / "scene.txt").string(), state = (folder / "state").string();
  writeFile(folder / "scene.txt", bundleText());
  const auto jsonOf = [](const CommandResult& result) { return nlohmann::json::parse(result.output); };
  for (const auto& [writing, reading] : {std::pair(3, 1), std::pair(1, 2)}) {
    const CommandResult cut = runSlom(
        writing, {"bundle", file, "--quiet", "--json", "-", "--max-iterations", "1", "--checkpoint", state});
    EXPECT_EQ(cut.exit_code, 1) << cut.errors;
    const CommandResult rest =
        runSlom(reading, {"bundle", file, "--quiet", "--json", "-", "--resume", state});
    ASSERT_EQ(rest.exit_code, 0) << rest.errors;
    const double before = jsonOf(cut)["final_rss"];
    EXPECT_NEAR(jsonOf(rest)["initial_rss"].get<double>(), before, 1e-10 * before);
  }
}

TEST(Checkpoints, OfOtherProblemsAreRefused) {
  const TemporaryFolder folder;
  const std::string map = (folder / "map.g2o").string(), state = (folder / "state").string();
  io::PoseGraph<io::Pose3> graph = io::testing::simulateGraph<io::Pose3>(40, 0.01, 3);
  writeFile(folder / "map.g2o", io::toG2o(graph));
  EXPECT_EQ(runSlom(2, {"graph", map, "--quiet", "--checkpoint", state}).exit_code, 0);
  graph.edges[7].measured.pos[1] += 1e-12;  // the same counts
  const std::string other = (folder / "other.g2o").string();
  writeFile(folder / "other.g2o", io::toG2o(graph));
  const std::regex refusal(
      "slom: state: the checkpoint is of another problem \\(graph of 40 poses, 10 landmarks, 80 edges, data "
      "([0-9a-f]{16}) instead of graph of 40 poses, 10 landmarks, 80 edges, data ([0-9a-f]{16})\\); give the folder "
      "of a run on the same file\n");
  for (const int processes : {1, 2, 3}) {
    const CommandResult refused = runSlom(processes, {"graph", other, "--resume", state});
    const std::string said = replaced(sentencesOfSlom(refused.errors), folder.path().string() + "/", "");
    std::smatch data;
    ASSERT_TRUE(std::regex_match(said, data, refusal)) << said;
    EXPECT_NE(data[1], data[2]);
    EXPECT_EQ(refused.exit_code, 2);
    const CommandResult missing = runSlom(processes, {"graph", map, "--resume", (folder / "none").string()});
    EXPECT_EQ(replaced(sentencesOfSlom(missing.errors), folder.path().string() + "/", ""),
              "slom: none: no checkpoint is there; give the folder of --checkpoint of an earlier run\n");
  }
}

TEST(Checkpoints, ThatAreDamagedAreRefused) {
  const TemporaryFolder folder;
  const std::string map = (folder / "map.g2o").string(), state = (folder / "state").string();
  writeFile(folder / "map.g2o", io::toG2o(io::testing::simulateGraph<io::Pose3>(40, 0.01, 3)));
  EXPECT_EQ(runSlom(2, {"graph", map, "--quiet", "--checkpoint", state}).exit_code, 0);
  std::filesystem::path values;
  for (const auto& entry : std::filesystem::directory_iterator(state)) {
    if (entry.path().filename().string().ends_with("-1-of-2")) values = entry.path();
  }
  const std::string content = readFile(values);
  const auto expectRefused = [&](const std::string& damaged, const std::string& what) {
    writeFile(values, damaged);
    const CommandResult refused = runSlom(1, {"graph", map, "--resume", state});
    EXPECT_NE(refused.errors.find("-1-of-2: damaged or missing; begin again without it\n"), std::string::npos)
        << what << ": " << refused.errors;
    EXPECT_EQ(refused.exit_code, 2) << what;
  };
  expectRefused("", "empty");
  expectRefused(content + "x", "longer");
  std::mt19937 random(freshSeed());
  for (int i = 0; i < 20; ++i) {
    const std::size_t at = random() % content.size();
    expectRefused(content.substr(0, at), "cut at " + std::to_string(at));
    std::string damaged = content;
    damaged[at] = char(damaged[at] ^ (1 << random() % 8));
    expectRefused(damaged, "a bit of byte " + std::to_string(at));
  }
  writeFile(values, content);
  EXPECT_EQ(runSlom(1, {"graph", map, "--quiet", "--resume", state}).exit_code, 0);
}

TEST(Checkpoints, AreRefusedBeforeTheFitIfTheyCannotBeWritten) {
  const TemporaryFolder folder;
  const std::string map = (folder / "map.g2o").string(), state = (folder / "map.g2o" / "state").string();
  writeFile(folder / "map.g2o", io::toG2o(io::testing::simulateGraph<io::Pose3>(40, 0.01, 3)));
  for (const int processes : {1, 2}) {
    const CommandResult refused = runSlom(processes, {"graph", map, "--checkpoint", state});
    EXPECT_EQ(
        replaced(sentencesOfSlom(refused.errors), folder.path().string() + "/", ""),
        "slom: map.g2o/state: cannot be written (Not a directory); give a folder that exists or can be made, on a "
        "disk with space, in which you may write\n");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(refused.output.find("iteration"), std::string::npos);
  }
}

}  // namespace
}  // namespace slom::testing
