// Corner files that broke the command once, of the public data sets.
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/faults.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::readFile;
using slom::testing::sharedDataPath;

std::string hostile(const std::string& name) { return sharedDataPath("hostile/" + name).string(); }

TEST(CalibrateHostile, ACoordinateBeyondAllImages) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/segv_left.csv");
  const auto result = testing::runCalibrate(
      {"--camera", "l=" + hostile("segv_left.csv"), "--camera", "r=" + hostile("segv_right.csv")});
  EXPECT_EQ(result.errors,
            "slom: " + hostile("segv_left.csv") +
                ":81: v_px is \"1e155\"; write a number from -1e+06 to 1e+06 there, or remove the row\n");
  EXPECT_EQ(result.exit_code, 2);
}

TEST(CalibrateHostile, CornersOutsideOfTheStatedImages) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/nl.csv");
  const auto result = testing::runCalibrate({"--camera", "l=" + hostile("nl.csv")});
  EXPECT_EQ(result.errors,
            "slom: " + hostile("nl.csv") +
                ":3: corner 5 of image 1 of camera l is at the pixel (655.85, 112.477), outside the image of "
                "640 x 480 px, like 128 of 144 corners; correct the size or the corners\n");
  EXPECT_EQ(result.exit_code, 2);
}

TEST(CalibrateHostile, NumbersThatAreNotFiniteAreNeverWritten) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/nl.csv");
  const slom::testing::TemporaryFolder folder;
  const std::string left =
      readFile(hostile("nl.csv"));  // the size in its first line is not that of its corners
  slom::testing::writeFile(folder / "nl.csv", left.substr(left.find('\n') + 1));
  const auto result =
      testing::runCalibrate({"--camera", "l=" + (folder / "nl.csv").string(), "--camera",
                             "r=" + hostile("nl_right.csv"), "--intrinsics", "radial1", "--json",
                             (folder / "r.json").string(), "--report", (folder / "r.html").string()});
  const std::regex not_finite(R"((^|[^a-zA-Z_])-?(nan|inf)([^a-zA-Z_(]|$))", std::regex::icase);
  const std::string json = readFile(folder / "r.json"), page = readFile(folder / "r.html");
  EXPECT_FALSE(std::regex_search(json, not_finite));
  EXPECT_FALSE(std::regex_search(result.output, not_finite));
  const std::size_t data = page.find("{\"verdict\"");
  ASSERT_NE(data, std::string::npos);
  EXPECT_FALSE(std::regex_search(page.substr(data, page.find("</script>", data) - data), not_finite));
  EXPECT_NE(nlohmann::json::parse(json)["quality"]["verdict"]["level"], "trustworthy");
}

/// A corner that is far off may leave no start values. The message is then about the data, not about functions of the
/// library.
TEST(CalibrateHostile, ACornerFarOffThatIsKept) {
  const std::string good = readFile(slom::testing::sourcePath("data/opencv_stereo/left_corners.csv"));
  const slom::testing::TemporaryFolder folder;
  const std::string file = (folder / "left.csv").string();
  int refused = 0;
  for (const int row : {20, 120, 333}) {
    for (const char* const digits : {"3", "30"}) {  // thousands of pixels before u
      std::size_t at = good.find("u_px");
      for (int i = 0; i < row; ++i) at = good.find('\n', at) + 1;
      for (int comma = 0; comma < 5; ++comma) at = good.find(',', at) + 1;
      slom::testing::writeFile(folder / "left.csv", std::string(good).insert(at, digits));
      const auto result = testing::runCalibrate({"--camera", "left=" + file, "--robust", "none"});
      EXPECT_EQ(result.errors.find("measurement"), std::string::npos) << result.errors;
      if (result.exit_code != 2) continue;
      ++refused;
      EXPECT_TRUE(
          result.errors ==
              "slom: " + file +
                  ": no start values were found at which the lens sees all corners; look for corners that "
                  "are far off, or leave them out by --robust reject\n" ||
          result.errors.find("lie on a line") != std::string::npos)
          << result.errors;
    }
  }
  EXPECT_GE(refused, 1);
}

/// The number of rows in the page's tables follows the shape of the images, within a limit.
TEST(CalibrateHostile, ImagesOfAnOddShapeHaveASmallPage) {
  const testing::Files files;
  const slom::testing::TemporaryFolder folder;
  for (const std::string size : {"1000x100000", "100000x1000", "100000x100000"}) {
    const auto result =
        testing::runIn(folder, files,
                       {"--camera", "left=DIR/left.csv", "--camera", "right=DIR/right.csv", "--image-size",
                        size, "--intrinsics", "radial1", "--report", "DIR/page.html", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_LT(std::filesystem::file_size(folder / "page.html"), 1'000'000u) << size;
  }
}

}  // namespace
}  // namespace slom::app::calib
