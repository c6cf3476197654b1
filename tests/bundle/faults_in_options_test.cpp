// Every mistake in the options, files that cannot be written, fits that fail.
#include "bundle/bundle_command.hpp"

namespace slom::app::bundle {
namespace {

using testing::command;
using testing::TemporaryFolder;

const std::string content =
    testing::contentOf(testing::perturbed(testing::simulated(3, 20, 0.2, 1), 0.02, 2));

void expectOptionsRefused(const std::string& sentence, const std::vector<std::string>& options) {
  command.expectRefused(content, sentence, options);
}

TEST(BundleOptions, NoFile) {
  const auto result = command.run({});
  EXPECT_EQ(result.errors, "slom: FILE is required; see slom bundle --help\n");
  EXPECT_EQ(result.exit_code, 2);
}
TEST(BundleOptions, Algorithms) {
  expectOptionsRefused("--solver lu: unknown solver; give auto, cholesky, cg, qr or dense-qr",
                       {"--solver", "lu"});
  expectOptionsRefused("--algorithm newton: unknown algorithm; give gn, lm or dogleg",
                       {"--algorithm", "newton"});
  for (const std::string name : {"gn", "dogleg"}) {
    expectOptionsRefused(
        "--algorithm " + name +
            ": cannot hold the free place, rotation and scale of a scene, as the damping of lm does; drop "
            "this "
            "option",
        {"--algorithm", name});
  }
}
TEST(BundleOptions, SharedOptionsAreChecked) {
  expectOptionsRefused("--robust huber: write huber:SCALE; SCALE is a positive number of standard deviations",
                       {"--robust", "huber"});
  expectOptionsRefused("--threads -1: give a number from 0 on", {"--threads", "-1"});
  expectOptionsRefused("--max-iterations 0: give a number from 1 on", {"--max-iterations", "0"});
}
TEST(BundleOptions, Tolerance) {
  for (const std::string number : {"-1", "1", "nan"}) {
    expectOptionsRefused("--tolerance " + number + ": give a number from 0 on, and below 1",
                         {"--tolerance", number});
  }
  expectOptionsRefused("Could not convert: --tolerance = small; see slom bundle --help",
                       {"--tolerance", "small"});
}
TEST(BundleOptions, ExtensionsOfResults) {
  for (const std::string name : {"scene", "scene.obj", "scene.ply.gz", "txt"}) {
    expectOptionsRefused(
        "--output " + name +
            ": unknown format; give FILE.txt or FILE.bal (a scene in BAL's format) or FILE.ply (a cloud of "
            "points)",
        {"--output", name});
  }
}
TEST(BundleOptions, ResultsThatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<std::string>& options) {
    const auto result = command.runIn(folder, content, options);
    EXPECT_EQ(result.output, "");
    EXPECT_EQ(result.exit_code, 2);
    return result.errors;
  };
  EXPECT_EQ(refused({"--output", "DIR/good.ply", "--output", "DIR/no/such.txt"}),
            "slom: cannot write no/such.txt: No such file or directory; name a file in a folder that exists "
            "and may be "
            "written\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "good.ply"));
  EXPECT_EQ(refused({"--json", "DIR/."}), "slom: --json .: this is a folder; give the name of a file\n");
  EXPECT_EQ(refused({"--output", "DIR/scene.txt"}),
            "slom: --output scene.txt: this is the file of FILE too; give another one\n");
  EXPECT_EQ(refused({"--output", "DIR/a.ply", "--output", "DIR/./a.ply"}),
            "slom: --output ./a.ply: this is the file of --output too; give another one\n");
  EXPECT_EQ(slom::testing::readFile(folder / "scene.txt"), content);
}

TEST(BundleOptions, AFitThatDoesNotConvergeSaysSo) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "fitted.txt", "the old one");
  const auto result = command.runIn(
      folder, content, {"--max-iterations", "1", "--json", "DIR/result.json", "--output", "DIR/fitted.txt"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors, "slom: the fit failed: iteration limit of 1 reached; raise --max-iterations\n");
  EXPECT_NE(result.output.find("\nNOT CONVERGED after 1 iteration: iteration limit reached\n"),
            std::string::npos);
  EXPECT_TRUE(
      result.output.ends_with("\nnot written, because the fit failed: fitted.txt\nwritten: result.json\n"))
      << result.output;
  EXPECT_EQ(testing::Json::parse(slom::testing::readFile(folder / "result.json"))["converged"], false);
  EXPECT_EQ(slom::testing::readFile(folder / "fitted.txt"), "the old one");
}

}  // namespace
}  // namespace slom::app::bundle
