// The command on files compressed by bzip2.
#include <slom/io/bal.hpp>

#include "bundle/bundle_command.hpp"

namespace slom::app::bundle {
namespace {

using slom::testing::sourcePath;
using testing::command;

/// Returns scene.txt compressed by bzip2's program, under a name without the extension.
std::string compressedScene() {
  const slom::testing::TemporaryFolder folder;
  std::filesystem::copy_file(sourcePath("data/simulated_bundle/scene.txt"), folder / "scene");
  const auto result = slom::testing::runCommand({"/usr/bin/env", "bzip2", (folder / "scene").string()});
  return result.exit_code == 0 ? slom::testing::readFile(folder / "scene.bz2") : "";
}

TEST(BundleCompressed, AFileOfFiveGigabytesInFourThousandBytes) {
  if (!io::has_bzip2) GTEST_SKIP() << "built without libbz2";
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/bomb.bz2");
  const std::string file = slom::testing::sharedDataPath("hostile/bomb.bz2").string();
  const auto result = command.run({file});
  EXPECT_EQ(result.errors,
            "slom: " + file +
                ": its 3762 bytes unpack to more than 16777216, too many for a scene; get the file "
                "again\n");
  EXPECT_EQ(result.exit_code, 2);
}

TEST(BundleCompressed, TheNameDoesNotMatter) {
  if (!io::has_bzip2) GTEST_SKIP() << "built without libbz2";
  const std::string compressed = compressedScene();
  if (compressed.empty()) GTEST_SKIP() << "needs the program bzip2";
  const auto plain = testing::fitted(slom::testing::readFile(sourcePath("data/simulated_bundle/scene.txt")));
  EXPECT_EQ(testing::fitted(compressed).bal, plain.bal);
  command.expectRefused(compressed.substr(0, 1000),
                        "scene.txt: the compressed file ends too early; get it again");
}

}  // namespace
}  // namespace slom::app::bundle
