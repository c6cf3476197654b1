// SLOM_KERNELS: the kernels for AVX2 and for AVX-512 give the same bits.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <slom/solve/instruction_set.hpp>

#include "graph/graph_command.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::app::graph {
namespace {

using testing::Json;

/// Sets the environment of commands that a test runs.
class KernelsOfCommands {
 public:
  explicit KernelsOfCommands(const char* name) { ::setenv("SLOM_KERNELS", name, 1); }
  ~KernelsOfCommands() { ::unsetenv("SLOM_KERNELS"); }
};

/// Erases values that may differ between two equal runs, at any depth.
void eraseTimes(Json& json) {
  if (json.is_object()) {
    for (const char* key : {"seconds", "peak_memory_mb", "phases"}) json.erase(key);
    std::erase_if(json.get_ref<Json::object_t&>(),
                  [](const auto& entry) { return entry.first.find("seconds") != std::string::npos; });
  }
  for (auto& part : json) {
    if (part.is_structured()) eraseTimes(part);
  }
}

/// The JSON of a run with these kernels, without times, memory and the kernels' name.
std::string numbersBy(const char* kernels, const std::vector<std::string>& words) {
  const KernelsOfCommands environment(kernels);
  std::vector<std::string> all = {slom::testing::commandPath().string()};
  all.insert(all.end(), words.begin(), words.end());
  all.insert(all.end(), {"--quiet", "--json", "-"});
  const auto result = slom::testing::runCommand(all);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  Json json = Json::parse(result.output, nullptr, false);
  EXPECT_NE(json["kernels"], "portable");
  json.erase("kernels");
  eraseTimes(json);
  return json.dump(1);
}

TEST(Kernels, GiveTheSameBitsWithAvx2AndAvx512) {
  SLOM_SKIP_WITH_SANITIZERS();
  if (std::string(slom::instructionSet()) != "AVX-512") GTEST_SKIP() << "this processor has no AVX-512";
  std::vector<std::vector<std::string>> runs = {
      {"graph", slom::testing::sourcePath("data/simulated_pose_graph/town.g2o").string()},
      {"bundle", slom::testing::sourcePath("data/simulated_bundle/scene.txt").string()}};
  for (const char* file : {"intel", "manhattan", "smallGrid3D", "parking-garage"}) {
    const auto path = slom::testing::sharedDataPath("posegraph/" + std::string(file) + ".g2o");
    if (std::filesystem::exists(path)) runs.push_back({"graph", path.string()});
    if (std::filesystem::exists(path)) runs.push_back({"graph", path.string(), "--online"});
  }
  for (const char* model : {"opencv5", "double_sphere"}) {
    runs.push_back({"calibrate", "--intrinsics", model, "--camera",
                    "left=" + slom::testing::sourcePath("data/opencv_stereo/left_corners.csv").string(),
                    "--camera",
                    "right=" + slom::testing::sourcePath("data/opencv_stereo/right_corners.csv").string()});
  }
  for (const auto& words : runs) EXPECT_EQ(numbersBy("avx2", words), numbersBy("avx512", words)) << words[1];
}

TEST(Kernels, ThatDoNotExistAreRefused) {
  const KernelsOfCommands environment("neon");
  const auto result = slom::testing::runCommand({slom::testing::commandPath().string(), "--version"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(
      result.errors.find(
          "SLOM_KERNELS is \"neon\", which names no kernels; set it to avx512, avx2 or sse2, or unset it"),
      std::string::npos)
      << result.errors;
}

}  // namespace
}  // namespace slom::app::graph
