// Points behind cameras and in their planes, and observations that spoil all.
#include "bundle/bundle_command.hpp"

namespace slom::app::bundle {
namespace {

using testing::command;
using testing::RawScene;
using testing::TemporaryFolder;

/// The scene with a point that starts as far behind the first camera as it is in front of it.
RawScene mirrored(int point, std::uint64_t seed) {
  RawScene scene = testing::simulated(5, 30, 0.3, seed);
  scene.points[std::size_t(point)][2] = 14;  // all cameras look from about z = 6 towards 0
  return scene;
}

TEST(BundleBehind, PointsBehindTheirCamerasAreNamed) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const int point = int(4 + seed);
    const TemporaryFolder folder;
    const auto result =
        command.runIn(folder, testing::contentOf(mirrored(point, seed)),
                      {"--json", "DIR/result.json", "--output", "DIR/fitted.txt", "--max-iterations", "300"});
    if (result.exit_code != 0) continue;
    const RawScene end = testing::sceneOf(slom::testing::readFile(folder / "fitted.txt"));
    int behind = 0;
    for (const auto& o : end.observations) {
      const auto& c = end.cameras[std::size_t(o.camera)];
      const auto& X = end.points[std::size_t(o.point)];
      behind += testing::rotated({c[0], c[1], c[2]}, {X[0], X[1], X[2]})[2] + c[5] > 0 ? 1 : 0;
    }
    const auto warnings = testing::Json::parse(slom::testing::readFile(folder / "result.json"))["warnings"];
    const std::string said = warnings.dump();
    if (behind == 0) {
      EXPECT_EQ(said.find("behind"), std::string::npos) << said;
      continue;
    }
    EXPECT_NE(said.find("1 point (number " + std::to_string(point) + ") ends behind cameras that see it (" +
                        std::to_string(behind) + " observation" + (behind == 1 ? "" : "s") + ")"),
              std::string::npos)
        << said;
    EXPECT_NE(result.output.find("  warning: 1 point (number " + std::to_string(point) + ") ends behind"),
              std::string::npos)
        << result.output;
  }
}

TEST(BundleBehind, GoodScenesAreNotWarnedOf) {
  const auto json = testing::fitted(testing::perturbed(testing::simulated(4, 30, 0.3, 41), 0.01, 42)).json;
  EXPECT_EQ(json["warnings"], testing::Json::array());
}

TEST(BundleBehind, APointInThePlaneOfItsCameraIsRefused) {
  RawScene scene = testing::simulated(3, 20, 0.3, 3);
  scene.cameras[1] = {0, 0, 0, 0.5, -0.25, -6, 500, -0.1, 0.02};
  scene.points[4] = {1, 2, 6 + 1e-13};
  command.expectRefused(
      testing::contentOf(scene),
      "scene.txt:15: point 4 lies in the plane of camera 1 (depth 1e-13 at a distance of 2.3), where a point "
      "has no image; correct the point or the camera, or remove the observation");
}

/// Failed fits name the observation that has nearly all of the sum of squares, and no function of the library.
TEST(BundleBehind, AnObservationThatSpoilsAllIsNamed) {
  RawScene scene = testing::simulated(3, 20, 0.3, 3);
  scene.observations[7].u = 9e5;
  const TemporaryFolder folder;
  const auto result = command.runIn(folder, testing::contentOf(scene), {"--max-iterations", "2"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.errors.starts_with(
      "slom: the fit failed: iteration limit of 2 reached; raise --max-iterations; the observation on line 9, of "
      "point 2 by camera 1, has "))
      << result.errors;
  EXPECT_TRUE(result.errors.ends_with("% of the sum of squares: correct or remove it\n")) << result.errors;
}

}  // namespace
}  // namespace slom::app::bundle
