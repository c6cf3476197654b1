// The patch around a corner, decoded again by a reader of its own.
#include <gtest/gtest.h>

#include "calibrate/detect/photo_patch.hpp"
#include "calibrate/detect/photograph.hpp"
#include "detect/rendered_board.hpp"
#include "support/run_command.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::TemporaryFolder;
using slom::testing::writeFile;

/// The picture of a data URI; base64 is Python's.
Photograph decoded(const TemporaryFolder& folder, const std::string& uri) {
  writeFile(folder / "patch.uri", uri);
  const auto result = slom::testing::runCommand(
      {"/usr/bin/python3", "-c",
       "import base64, sys; open(sys.argv[2], "
       "'wb').write(base64.b64decode(open(sys.argv[1]).read().split(',')[1], validate=True))",
       (folder / "patch.uri").string(), (folder / "patch.png").string()});
  EXPECT_EQ(result.errors, "");
  std::string reason;
  const auto photo = readPhotograph((folder / "patch.png").string(), reason);
  EXPECT_TRUE(photo) << reason;
  return photo.value_or(Photograph{});
}

TEST(PhotoPatch, ShowsThePixelsAroundACorner) {
  const TemporaryFolder folder;
  Photograph photo{{20, 10}, std::vector<std::uint8_t>(200)};
  for (std::size_t i = 0; i < 200; ++i) photo.grey[i] = std::uint8_t(i + 20);
  testing::writePgm(folder / "left1.pgm", photo);
  for (const auto& [u, v] : {std::pair(7.3, 4.6), {0.2, 0.1}, {19.4, 9.}}) {
    const std::string uri = photoPatch((folder / "left1.pgm").string(), vec2(u, v), 2, 3);
    EXPECT_TRUE(uri.starts_with("data:image/png;base64,"));
    const Photograph patch = decoded(folder, uri);
    ASSERT_EQ(patch.size.width, 15);
    ASSERT_EQ(patch.size.height, 15);
    for (int row = 0; row < 15; ++row) {
      for (int column = 0; column < 15; ++column) {
        const int x = int(std::lround(u)) - 2 + column / 3, y = int(std::lround(v)) - 2 + row / 3;
        const bool inside = x >= 0 && y >= 0 && x < 20 && y < 10;
        EXPECT_EQ(patch.grey[std::size_t(15 * row + column)], inside ? 20 * y + x + 20 : 0)
            << column << " " << row;
      }
    }
  }
}

TEST(PhotoPatch, IsEmptyWithoutAPhotograph) {
  const TemporaryFolder folder;
  writeFile(folder / "left1.pgm", "nothing");
  EXPECT_EQ(photoPatch((folder / "left1.pgm").string(), vec2(1., 1.)), "");
  EXPECT_EQ(photoPatch((folder / "lost.pgm").string(), vec2(1., 1.)), "");
}

TEST(Photograph, OfSixteenBitsUsesAllOfTheRange) {
  const TemporaryFolder folder;
  const auto made = slom::testing::runCommand({"/usr/bin/python3", "-c",
                                               "import sys, cv2, numpy; cv2.imwrite(sys.argv[1], "
                                               "numpy.array([[0, 1000], [2000, 4000]], numpy.uint16))",
                                               (folder / "deep.png").string()});
  if (made.exit_code != 0) GTEST_SKIP() << "needs Debian's python3-opencv";
  std::string reason;
  const auto photo = readPhotograph((folder / "deep.png").string(), reason);
  ASSERT_TRUE(photo) << reason;
  EXPECT_EQ(photo->grey, (std::vector<std::uint8_t>{0, 64, 128, 255}));

  writeFile(folder / "deep.pgm", std::string("P5\n1 1\n4095\n\x01\x02"));
  EXPECT_FALSE(readPhotograph((folder / "deep.pgm").string(), reason));
  EXPECT_EQ(reason, "is a PGM of 16 bits, which must be converted, to PNG for example");
}

}  // namespace
}  // namespace slom::app::calib
