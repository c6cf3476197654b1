// Image numbers that are time stamps: paired by the nearest, in memory and from files.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "support/temporary_folder.hpp"

namespace slom::calibration {
namespace {

using Sources = std::vector<std::vector<std::string>>;

TEST(ImageNumbers, AreThemselvesUpToTheLargestInt) {
  const ImageNumbers numbers(Sources{{"7", "2147483647"}});
  EXPECT_FALSE(numbers.areStamps());
  EXPECT_EQ(numbers.of(0, "2147483647"), 2147483647);
  EXPECT_EQ(sentenceOf(numbers), "");
}

TEST(ImageNumbers, StampsAreCountedInTheirOrder) {
  const ImageNumbers numbers(Sources{{"1402065930515759104", "1402065930415759104"}});
  EXPECT_TRUE(numbers.areStamps());
  EXPECT_EQ(numbers.of(0, "1402065930415759104"), 1);
  EXPECT_EQ(numbers.of(0, "1402065930515759104"), 2);
}

TEST(ImageNumbers, StampsThatDifferALittleAreOneImage) {
  const ImageNumbers numbers({{"1402065930000000000", "1402065930100000000", "1402065930200000000"},
                              {"1402065930000001500", "1402065930200000700", "1402065930290000000"}});
  EXPECT_EQ(numbers.of(1, "1402065930000001500"), numbers.of(0, "1402065930000000000"));
  EXPECT_EQ(numbers.of(1, "1402065930200000700"), numbers.of(0, "1402065930200000000"));
  EXPECT_EQ(numbers.of(1, "1402065930290000000"), 4);  // its nearest one is taken
  EXPECT_EQ(numbers.paired(), 2u);
  EXPECT_NEAR(numbers.largestDifference(), 1500, 1e-6);
  EXPECT_EQ(
      sentenceOf(numbers),
      "image numbers are time stamps; 2 images pair the nearest stamps of different cameras, which differ "
      "by up to 1500, 0.0015 % of their spacing");
}

TEST(ImageNumbers, FilesWithStampsAndOldLineEndsAreRead) {
  const slom::testing::TemporaryFolder folder;
  const std::string header = "# old\rimage,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\r";
  std::string left = header, right = header;
  for (const char* stamp : {"1402065930000000000", "1402065930100000000"}) {
    left += std::string(stamp) + ",1,0,0,0,1,2\r";
    right += std::string(stamp).substr(0, 16) + "150,1,0,0,0,1,2\r";
  }
  std::ofstream(folder / "l.csv", std::ios::binary) << left;
  std::ofstream(folder / "r.csv", std::ios::binary) << right;
  ImageNumbers numbers;
  const Dataset data = readRig({{"l", {std::filesystem::path(folder / "l.csv").string()}},
                                {"r", {std::filesystem::path(folder / "r.csv").string()}}},
                               "", &numbers);
  ASSERT_EQ(data.cameras[1].views.size(), 2u);
  EXPECT_EQ(data.images(), (std::vector<int>{1, 2}));
  EXPECT_EQ(numbers.paired(), 2u);
  EXPECT_EQ(data.cameras[0].views[1].corners[0].line, 4);
}

TEST(ImageNumbers, LongDigitsAreTimes) {
  EXPECT_EQ(timeInDigits("1404733405732800001"), 1404733405732800001);
  EXPECT_EQ(timeInDigits("1404733405732800"), 1404733405732800000);
  EXPECT_EQ(timeInDigits("1404733405"), std::nullopt);
  EXPECT_EQ(timeInDigits("9999999999999999999"), std::nullopt);  // beyond 64 bits
}

}  // namespace
}  // namespace slom::calibration
