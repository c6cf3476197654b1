// The single place in which libslom_detect.so is searched.
#include <filesystem>
#include <unistd.h>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "calibrate/detect/detector_module.hpp"
#include "error.hpp"
#include "support/paths.hpp"
#include "support/refusal_of.hpp"
#include "support/run_command.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::refusalOf;
namespace fs = std::filesystem;

TEST(DetectorModule, OfTheBuildTreeIsWhereItWasBuilt) {
  const fs::path built = slom::testing::commandPath().parent_path() / "libslom_detect.so";
  EXPECT_EQ(detectorFile(slom::testing::commandPath()), built);
  EXPECT_EQ(detectorFile(fs::read_symlink("/proc/self/exe")), built) << "a test";
  EXPECT_TRUE(fs::exists(built));
}

TEST(DetectorModule, OfAnInstalledProgramIsBesideIt) {
  const fs::path file = detectorFile("/opt/slom/bin/slom");
  EXPECT_TRUE(file.string().starts_with("/opt/slom/lib")) << file;
  EXPECT_EQ(file.filename(), "libslom_detect.so");
  const fs::path tree = slom::testing::commandPath().parent_path().parent_path();
  EXPECT_TRUE(detectorFile(tree.string() + "2/bin/slom").string().starts_with(tree.string() + "2/lib"));
}

TEST(DetectorModule, IsNotFoundWhereTheProgramIsNotKnown) {
  for (const fs::path program : {"", "slom", "./slom"}) {
    try {
      detectorFile(program);
      FAIL() << "no error";
    } catch (const UserError& error) {
      EXPECT_STREQ(error.what(),
                   "--images: the system does not say where this program is installed, so "
                   "libslom_detect.so, which finds boards, cannot be located; mount /proc, or give the "
                   "corners by --camera NAME=FILE");
    }
  }
}

TEST(DetectorModule, HasNoPlaceWhereTheProgramIsNotInstalled) {
  for (const std::string program : {"/srv/x/slom", "/slom", "/opt/bin/x/slom", "/opt/xbin/slom"}) {
    const std::string refusal = refusalOf([&] { detectorFile(program); });
    EXPECT_TRUE(refusal.starts_with("--images: this program is not in its installation folder ")) << refusal;
    EXPECT_TRUE(refusal.ends_with("install slom as a whole, or give the corners by --camera NAME=FILE"))
        << refusal;
  }
}

TEST(DetectorModule, OfOthersIsNotTrusted) {
  const slom::testing::TemporaryFolder folder;
  const fs::path library = folder / "libslom_detect.so", program = folder / "slom";
  slom::testing::writeFile(library, "x");
  slom::testing::writeFile(program, "x");
  const auto refusal = [&] { return refusalOf([&] { requireTrusted(library, program); }); };
  EXPECT_EQ(refusal(), "no error");
  const std::string remedy =
      ", so it is not loaded; install slom as a whole, or give the corners by --camera NAME=FILE";
  ASSERT_EQ(::chmod(library.c_str(), 0666), 0);
  EXPECT_EQ(refusal(), "--images: " + library.string() + " is writable by everybody" + remedy);
  ASSERT_EQ(::chmod(library.c_str(), 0644), 0);
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file to somebody else";
  ASSERT_EQ(::chown(library.c_str(), 12345, 12345), 0);
  EXPECT_EQ(refusal(), "--images: " + library.string() +
                           " belongs neither to the owner of this program nor to root" + remedy);
  ASSERT_EQ(::chown(program.c_str(), 12345, 12345), 0);
  EXPECT_EQ(refusal(), "no error");
}

/// A copy of the program, with files of that name in the working directory, beside the program, and in neighbouring
/// folders.
TEST(DetectorModule, OfOthersIsNotLoaded) {
  const slom::testing::TemporaryFolder folder;
  fs::create_directories(folder / "slom/bin");
  fs::copy_file(slom::testing::commandPath(), folder / "slom/bin/slom");
  for (const std::string name : {".", "slom", "slom/bin", "slom/apps", "apps"})
    slom::testing::writeFile(folder / name / "libslom_detect.so", "x");
  slom::testing::writeFile(folder / "left1.pgm", "P5\n1 1\n255\nx");
  const auto result = slom::testing::runCommand({"/usr/bin/env", "-C", folder.path().string(),
                                                 (folder / "slom/bin/slom").string(), "calibrate", "--board",
                                                 "9x6", "--square", "1", "--images", "left=left*.pgm"});
  EXPECT_EQ(
      result.errors,
      "slom: --images: " + detectorFile(folder / "slom/bin/slom").string() +
          ", which finds boards, is missing; install slom as a whole, or give the corners by --camera NAME=FILE\n");
  EXPECT_EQ(result.exit_code, 2);
}

}  // namespace
}  // namespace slom::app::calib
