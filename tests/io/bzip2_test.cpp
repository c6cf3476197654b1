// Files compressed by bzip2, with libbz2 and without it.
#include <gtest/gtest.h>

#include <slom/io/bal.hpp>

#include "support/message_of.hpp"
#include "support/run_command.hpp"
#include "support/temporary_folder.hpp"

// What is built where libbz2 is not there, under another name.
#define has_bzip2 has_bzip2_without_libbz2
#define bzip2Decompressed bzip2DecompressedWithoutLibbz2
#include "io/bal/bzip2_absent.cpp"
#undef has_bzip2
#undef bzip2Decompressed

namespace slom::io {
namespace {

/// `hello world\n`, as bzip2 writes it.
const std::string hello(
    "\102\132\150\071\061\101\131\046\123\131\116\354\350\066\000\000\002\121\200\000\020\100\000\006"
    "\104\220\200\040\000\061\006\114\101\001\247\251\245\200\273\224\061\370\273\222\051\302\204\202"
    "\167\147\101\260",
    52);

using slom::testing::messageOf;

std::string messageOfContent(const std::string& content) {
  return messageOf([&] { bzip2Decompressed("scene.bz2", content); });
}

TEST(Bzip2, WithoutLibbz2TheErrorSaysWhatToInstall) {
  EXPECT_EQ(
      messageOf([] { bzip2DecompressedWithoutLibbz2("scene.bz2", hello); }),
      "[slom.io.no-bzip2] scene.bz2: the file is compressed by bzip2, and this slom was built without libbz2; "
      "decompress it with bunzip2, or install libbz2-dev and build slom again");
}

TEST(Bzip2, StreamsOneAfterTheOther) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  EXPECT_EQ(bzip2Decompressed("scene.bz2", hello), "hello world\n");
  EXPECT_EQ(bzip2Decompressed("scene.bz2", hello + hello), "hello world\nhello world\n");
}

TEST(Bzip2, DamagedFiles) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  const std::string damaged = "[slom.io.damaged] scene.bz2: the compressed file is damaged; get it again";
  std::string other = hello;
  other[30] = char(other[30] ^ 8);
  EXPECT_EQ(messageOfContent(other), damaged);
  EXPECT_EQ(messageOfContent(hello + "more"), damaged);
  EXPECT_EQ(messageOfContent("BZhello"), damaged);
  for (const std::size_t size : {std::size_t(3), std::size_t(4), std::size_t(20), hello.size() - 1}) {
    EXPECT_EQ(messageOfContent(hello.substr(0, size)),
              "[slom.io.damaged] scene.bz2: the compressed file ends too early; get it again")
        << size;
  }
}

TEST(Bzip2, SmallFilesThatFillTheMemory) {
  if (!has_bzip2) GTEST_SKIP() << "built without libbz2";
  const slom::testing::TemporaryFolder folder;
  slom::testing::writeFile(folder / "zeros", std::string((16 << 20) + 1, '\0'));
  if (slom::testing::runCommand({"/usr/bin/env", "bzip2", (folder / "zeros").string()}).exit_code != 0)
    GTEST_SKIP() << "needs the program bzip2";
  const std::string bomb = slom::testing::readFile(folder / "zeros.bz2");
  EXPECT_EQ(messageOfContent(bomb),
            "[slom.io.damaged] scene.bz2: its " + std::to_string(bomb.size()) +
                " bytes unpack to more than 16777216, too many for a scene; get the file again");
}

}  // namespace
}  // namespace slom::io
