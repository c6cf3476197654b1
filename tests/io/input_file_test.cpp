// Files that are read as a whole: devices and sizes.
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <slom/io/input_file.hpp>

#include "support/message_of.hpp"
#include "support/temporary_folder.hpp"

namespace slom::io {
namespace {

using slom::testing::messageOf;
using slom::testing::TemporaryFolder;
using slom::testing::writeFile;

TEST(InputFile, OfAnySizeUpToTheMost) {
  const TemporaryFolder folder;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, (std::size_t{1} << 16) - 1,
                                 std::size_t{1} << 16, std::size_t{300'001}}) {
    std::string text(size, 'x');
    for (std::size_t i = 0; i < size; ++i) text[i] = char(i * 2654435761u >> 7);
    writeFile(folder / "file", text);
    EXPECT_EQ(readWhole((folder / "file").string()), text);
    EXPECT_EQ(readWhole((folder / "file").string(), size), text);
    if (size == 0) continue;
    EXPECT_EQ(messageOf([&] { readWhole((folder / "file").string(), size - 1); }),
              "[slom.io.too-large] " + (folder / "file").string() + ": larger than " +
                  std::to_string(size - 1) + " bytes, the limit; give a smaller file");
  }
}

TEST(InputFile, PipesAreReadToTheirEndAndNoLonger) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string text(200'000, 'y');
  const auto fed = [&](std::size_t most) {
    std::thread writer([&] { writeFile(pipe, text); });
    std::string result = messageOf([&] { EXPECT_EQ(readWhole(pipe, most), text); });
    writer.join();
    return result;
  };
  EXPECT_EQ(fed(largest_input), "no error");
  EXPECT_EQ(fed(200'000), "no error");
  EXPECT_EQ(fed(199'999),
            "[slom.io.too-large] " + pipe + ": larger than 199999 bytes, the limit; give a smaller file");
}

TEST(InputFile, DevicesAreRefused) {
  for (const std::string device : {"/dev/zero", "/dev/null", "/dev/full", "/dev/urandom"}) {
    EXPECT_EQ(messageOf([&] { readWhole(device); }),
              "[slom.io.device] " + device + ": this is a device; give a file or a pipe");
  }
}

TEST(InputFile, FilesThatAreNotThere) {
  EXPECT_EQ(
      messageOf([] { readWhole("/nowhere/map.g2o"); }),
      "[slom.io.cannot-read] /nowhere/map.g2o: cannot be read (No such file or directory); check the path");
  EXPECT_EQ(messageOf([] { readWhole("/proc"); }),
            "[slom.io.cannot-read] /proc: cannot be read (Is a directory); check the path");
}

}  // namespace
}  // namespace slom::io
