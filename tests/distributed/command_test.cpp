// `mpirun slom graph` and `mpirun slom bundle` give what one process gives.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <slom/io/g2o.hpp>

#include "distributed/bundle_text.hpp"
#include "distributed/mpirun.hpp"
#include "io/simulated_graph.hpp"

namespace slom::testing {
namespace {

using Json = nlohmann::json;

struct Fitted {
  Json json;
  std::string output;  ///< the file of --output
};

Fitted fitted(int processes, const std::string& subcommand, const std::string& file,
              const std::vector<std::string>& options, const std::string& extension) {
  const TemporaryFolder folder;
  const std::string output = (folder / ("fitted" + extension)).string(),
                    json = (folder / "result.json").string();
  std::vector<std::string> words{subcommand, file, "--quiet", "--output", output, "--json", json};
  words.insert(words.end(), options.begin(), options.end());
  const CommandResult result = runSlom(processes, words);
  EXPECT_EQ(sentencesOfSlom(result.errors), "");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, "");
  if (result.exit_code != 0) return {};
  return {Json::parse(readFile(json)), readFile(output)};
}

void expectSameResult(const Fitted& fit, const Fitted& alone, const std::string& what) {
  ASSERT_FALSE(fit.json.is_null()) << what;
  const double rss = alone.json["final_rss"];
  EXPECT_NEAR(double(fit.json["final_rss"]), rss, 1e-10 * rss) << what;
  for (const char* const key : {"variables", "measurements", "unknowns", "converged"})
    EXPECT_EQ(fit.json[key], alone.json[key]) << what << ": " << key;
  // The same lines in the same order, with numbers that may differ in the last digits.
  std::istringstream own(fit.output), other(alone.output);
  std::string line, other_line;
  while (std::getline(own, line)) {
    ASSERT_TRUE(std::getline(other, other_line)) << what;
    std::istringstream words(line), other_words(other_line);
    std::string word, other_word;
    while (words >> word) {
      ASSERT_TRUE(other_words >> other_word) << what << ": " << line;
      char *end = nullptr, *other_end = nullptr;
      const double value = std::strtod(word.c_str(), &end),
                   other_value = std::strtod(other_word.c_str(), &other_end);
      if (*end != '\0') {
        ASSERT_EQ(word, other_word) << what;
      } else {
        ASSERT_NEAR(value, other_value, 1e-7 * (1 + std::abs(value))) << what << ": " << line << "\n"
                                                                      << other_line;
      }
    }
  }
  EXPECT_FALSE(std::getline(other, other_line)) << what;
}

void compareGraph(const std::string& file, const std::vector<int>& processes,
                  std::vector<std::string> options = {}) {
  options.insert(options.end(), {"--init", "file"});
  const Fitted alone = fitted(1, "graph", file, options, ".g2o");
  for (const int P : processes)
    expectSameResult(fitted(P, "graph", file, options, ".g2o"), alone, file + " on " + std::to_string(P));
}

TEST(Graph, OfASimulationFitsAsInOneProcess) {
  const TemporaryFolder folder;
  writeFile(folder / "space.g2o", io::toG2o(io::testing::simulateGraph<io::Pose3>(40, 0.01, 3)));
  compareGraph((folder / "space.g2o").string(), {2, 4, 7});
  writeFile(folder / "plane.g2o", io::toG2o(io::testing::simulateGraph<io::Pose2>(30, 0.01, 4)));
  compareGraph((folder / "plane.g2o").string(), {3});
  compareGraph((folder / "plane.g2o").string(), {2}, {"--robust", "huber:1.5", "--algorithm", "lm"});
}

TEST(Containers, FitBitByBitAsTheirTexts) {
  const TemporaryFolder folder;
  const std::string map = (folder / "map.g2o").string(), scene = (folder / "scene.txt").string(),
                    binary = (folder / "problem.slom").string();
  writeFile(folder / "map.g2o", io::toG2o(io::testing::simulateGraph<io::Pose3>(40, 0.01, 3)));
  writeFile(folder / "scene.txt", bundleText());
  const auto compare = [&](const std::string& subcommand, const std::string& file,
                           const std::string& extension) {
    EXPECT_EQ(runSlom(1, {"convert", file, binary, "--quiet"}).exit_code, 0);
    const std::vector<std::string> options =
        subcommand == "graph" ? std::vector<std::string>{"--init", "file"} : std::vector<std::string>{};
    for (const int P : {1, 3}) {
      std::vector<std::string> same_bits = options;
      if (P > 1) same_bits.insert(same_bits.end(), {"--solver", "cg"});
      const Fitted from_text = fitted(P, subcommand, file, same_bits, extension),
                   from_container = fitted(P, subcommand, binary, same_bits, extension);
      EXPECT_EQ(from_text.output, from_container.output) << subcommand << " on " << P;
      EXPECT_EQ(from_text.json["final_rss"], from_container.json["final_rss"]);
    }
  };
  compare("graph", map, ".g2o");
  compare("bundle", scene, ".txt");
}

TEST(Graph, OfAPublicDataSetFitsAsInOneProcess) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/sphere2500.g2o");
  compareGraph(sharedDataPath("posegraph/sphere2500.g2o").string(), {3});
}

TEST(Graph, FitsByConjugateGradients) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/smallGrid3D.g2o");
  const std::string file = sharedDataPath("posegraph/smallGrid3D.g2o").string();
  const Fitted alone = fitted(1, "graph", file, {"--init", "file"}, ".g2o");
  const Fitted fit = fitted(3, "graph", file, {"--init", "file", "--solver", "cg"}, ".g2o");
  const Fitted again = fitted(3, "graph", file, {"--init", "file", "--solver", "cg"}, ".g2o");
  const double rss = alone.json["final_rss"];
  EXPECT_NEAR(double(fit.json["final_rss"]), rss, 1e-10 * rss);
  EXPECT_EQ(fit.output, again.output);  // bit by bit
}

void compareBundle(const std::string& file, const std::vector<int>& processes,
                   const std::vector<std::string>& options) {
  const Fitted alone = fitted(1, "bundle", file, options, ".txt");
  for (const int P : processes) {
    const Fitted fit = fitted(P, "bundle", file, options, ".txt");
    const double rss = alone.json["final_rss"];
    EXPECT_NEAR(double(fit.json["final_rss"]), rss, 1e-10 * rss) << file << " on " << P;
    for (const char* const key : {"variables", "measurements", "unknowns", "converged", "iterations"})
      EXPECT_EQ(fit.json[key], alone.json[key]) << file << " on " << P << ": " << key;
    EXPECT_EQ(std::count(fit.output.begin(), fit.output.end(), '\n'),
              std::count(alone.output.begin(), alone.output.end(), '\n'));
  }
}

TEST(Bundle, OfASimulationFitsAsInOneProcess) {
  const TemporaryFolder folder;
  writeFile(folder / "scene.txt", bundleText());
  compareBundle((folder / "scene.txt").string(), {2, 4, 7}, {});
  compareBundle((folder / "scene.txt").string(), {3}, {"--robust", "huber:1"});
}

TEST(Bundle, OfAPublicDataSetFitsAsInOneProcess) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("bal/problem-49-7776-pre.txt");
  compareBundle(sharedDataPath("bal/problem-49-7776-pre.txt").string(), {2}, {"--max-iterations", "50"});
}

}  // namespace
}  // namespace slom::testing
