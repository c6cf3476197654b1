// Several processes say about a scene what one process says.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bundle/raw_scene.hpp"
#include "distributed/mpirun.hpp"

namespace slom::testing {
namespace {

using Json = nlohmann::json;
using app::bundle::testing::RawScene;

/// Returns a scene of two parts, with a camera of few points, points that one camera sees, and a point that starts
/// behind its cameras.
RawScene faulty(std::uint64_t seed) {
  RawScene scene = app::bundle::testing::simulated(5, 40, 0.3, seed);
  const RawScene other = app::bundle::testing::simulated(4, 30, 0.3, seed + 100);
  for (const auto& o : other.observations) {
    if (o.camera == 3 && o.point >= 2 + int(seed % 3)) continue;
    scene.observations.push_back({o.camera + 5, o.point + 40, o.u, o.v});
  }
  scene.cameras.insert(scene.cameras.end(), other.cameras.begin(), other.cameras.end());
  scene.points.insert(scene.points.end(), other.points.begin(), other.points.end());
  const auto isDropped = [&](const auto& o) { return o.point >= 3 && o.point < 11 && o.camera != 1; };
  std::erase_if(scene.observations, isDropped);
  scene.points[20 + std::size_t(seed)][2] = 14;
  return scene;
}

struct Said {
  Json json;
  std::string output, errors;
};

Said said(int processes, const RawScene& scene, const std::vector<std::string>& options = {}) {
  const TemporaryFolder folder;
  writeFile(folder / "scene.txt", app::bundle::testing::contentOf(scene));
  const std::string json = (folder / "result.json").string();
  std::vector<std::string> words{"bundle", (folder / "scene.txt").string(), "--json", json};
  words.insert(words.end(), options.begin(), options.end());
  const CommandResult result = runSlom(processes, words);
  return {Json::parse(readFile(json)), replaced(result.output, folder.path().string() + "/", ""),
          sentencesOfSlom(result.errors)};
}

std::string beforeFit(const std::string& output) {
  return output.substr(output.find("  gauge:"),
                       output.rfind("  warning: the scene") - output.find("  gauge:"));
}

TEST(SceneCheck, SaysOnSeveralProcessesWhatOneSays) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RawScene scene = faulty(seed);
    const Said alone = said(1, scene, {"--max-iterations", "3"});
    ASSERT_GE(alone.json["warnings"].size(), 4u) << alone.json["warnings"];
    for (const int P : {2, 4}) {
      const Said fit = said(P, scene, {"--max-iterations", "3", "--solver", "cholesky"});
      EXPECT_EQ(fit.json["warnings"], alone.json["warnings"]) << "seed " << seed << ", " << P;
      EXPECT_EQ(fit.errors, alone.errors);
      EXPECT_EQ(beforeFit(fit.output), beforeFit(alone.output));
      EXPECT_LE(fit.json["free_directions"], alone.json["free_directions"]);
      EXPECT_GE(fit.json["free_directions"], 14 + 8);
      EXPECT_EQ(fit.json["free_directions_are_all"], false);
    }
  }
}

TEST(SceneCheck, NamesTheObservationThatSpoilsAll) {
  RawScene scene = app::bundle::testing::simulated(3, 20, 0.3, 3);
  scene.observations[7].u = 9e5;
  const std::string alone = said(1, scene, {"--max-iterations", "2"}).errors;
  EXPECT_NE(alone.find("the observation on line 9, of point 2 by camera 1, has "), std::string::npos)
      << alone;
  EXPECT_EQ(said(3, scene, {"--max-iterations", "2"}).errors, alone);
}

TEST(SceneCheck, RefusesAPointInThePlaneOfItsCameraOnce) {
  RawScene scene = app::bundle::testing::simulated(3, 20, 0.3, 3);
  scene.cameras[1] = {0, 0, 0, 0.5, -0.25, -6, 500, -0.1, 0.02};
  scene.points[4] = {1, 2, 6 + 1e-13};
  const TemporaryFolder folder;
  writeFile(folder / "scene.txt", app::bundle::testing::contentOf(scene));
  for (const int P : {1, 3}) {
    const CommandResult result = runSlom(P, {"bundle", (folder / "scene.txt").string()});
    EXPECT_EQ(
        sentencesOfSlom(result.errors),
        "slom: " + (folder / "scene.txt").string() +
            ":15: point 4 lies in the plane of camera 1 (depth 1e-13 at a distance of 2.3), where a point has no "
            "image; correct the point or the camera, or remove the observation\n");
    EXPECT_EQ(result.exit_code, 2);
  }
}

}  // namespace
}  // namespace slom::testing
