// Files compressed by bzip2, with libbz2 and without it.
#include "bundle/bundle_command.hpp"
#include "bundle/input/bzip2.hpp"
#include "bundle/input/read.hpp"
#include "error.hpp"

// What is built where libbz2 is not there, under another name.
#define has_bzip2 has_bzip2_without_libbz2
#define bzip2Decompressed bzip2DecompressedWithoutLibbz2
#include "bundle/input/bzip2_absent.cpp"
#undef has_bzip2
#undef bzip2Decompressed

namespace slom::app::bundle {
namespace {

using slom::testing::sourcePath;
using testing::command;

/// `hello world\n`, as bzip2 writes it.
const std::string hello(
    "\102\132\150\071\061\101\131\046\123\131\116\354\350\066\000\000\002\121\200\000\020\100\000\006"
    "\104\220\200\040\000\061\006\114\101\001\247\251\245\200\273\224\061\370\273\222\051\302\204\202"
    "\167\147\101\260",
    52);

std::string messageOf(const std::string& content) {
  try {
    return "no error: " + bzip2Decompressed("scene.bz2", content);
  } catch (const UserError& error) {
    return error.what();
  }
}

TEST(BundleCompressed, WithoutLibbz2TheErrorSaysWhatToInstall) {
  try {
    bzip2DecompressedWithoutLibbz2("scene.bz2", hello);
    FAIL() << "no error";
  } catch (const UserError& error) {
    EXPECT_STREQ(
        error.what(),
        "scene.bz2: the file is compressed by bzip2, and this slom was built without libbz2; decompress it "
        "with bunzip2, or install libbz2-dev and build slom again");
  }
}

TEST(BundleCompressed, StreamsOneAfterTheOther) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  EXPECT_EQ(bzip2Decompressed("scene.bz2", hello), "hello world\n");
  EXPECT_EQ(bzip2Decompressed("scene.bz2", hello + hello), "hello world\nhello world\n");
}

TEST(BundleCompressed, DamagedFiles) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  const std::string damaged = "scene.bz2: the compressed file is damaged; get it again";
  std::string other = hello;
  other[30] = char(other[30] ^ 8);
  EXPECT_EQ(messageOf(other), damaged);
  EXPECT_EQ(messageOf(hello + "more"), damaged);
  EXPECT_EQ(messageOf("BZhello"), damaged);
  for (const std::size_t size : {std::size_t(3), std::size_t(4), std::size_t(20), hello.size() - 1}) {
    EXPECT_EQ(messageOf(hello.substr(0, size)), "scene.bz2: the compressed file ends too early; get it again")
        << size;
  }
}

/// scene.txt compressed by the program, under a name that does not say so.
std::string compressedScene() {
  const slom::testing::TemporaryFolder folder;
  std::filesystem::copy_file(sourcePath("data/simulated_bundle/scene.txt"), folder / "scene");
  const auto result = slom::testing::runCommand({"/usr/bin/env", "bzip2", (folder / "scene").string()});
  return result.exit_code == 0 ? slom::testing::readFile(folder / "scene.bz2") : "";
}

TEST(BundleCompressed, SmallFilesThatFillTheMemory) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  const slom::testing::TemporaryFolder folder;
  slom::testing::writeFile(folder / "zeros", std::string((16 << 20) + 1, '\0'));
  if (slom::testing::runCommand({"/usr/bin/env", "bzip2", (folder / "zeros").string()}).exit_code != 0)
    GTEST_SKIP() << "needs the program bzip2";
  const std::string bomb = slom::testing::readFile(folder / "zeros.bz2");
  EXPECT_EQ(messageOf(bomb), "scene.bz2: its " + std::to_string(bomb.size()) +
                                 " bytes unpack to more than 16777216, which no scene does; get it again");
}

TEST(BundleCompressed, AFileOfFiveGigabytesInFourThousandBytes) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/bomb.bz2");
  const std::string file = slom::testing::sharedDataPath("hostile/bomb.bz2").string();
  const auto result = command.run({file});
  EXPECT_EQ(
      result.errors,
      "slom: " + file + ": its 3762 bytes unpack to more than 16777216, which no scene does; get it again\n");
  EXPECT_EQ(result.exit_code, 2);
}

TEST(BundleCompressed, TheNameDoesNotMatter) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  const std::string compressed = compressedScene();
  if (compressed.empty()) GTEST_SKIP() << "needs the program bzip2";
  const auto plain = testing::fitted(slom::testing::readFile(sourcePath("data/simulated_bundle/scene.txt")));
  EXPECT_EQ(testing::fitted(compressed).bal, plain.bal);
  command.expectRefused(compressed.substr(0, 1000),
                        "scene.txt: the compressed file ends too early; get it again");
}

}  // namespace
}  // namespace slom::app::bundle
