// ChArUco boards with a wrongly stated size, dictionary or pattern. The command names the one that the markers show.
#include "calibrate/detect/marker_layout.hpp"

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"
#include "detect/rendered_markers.hpp"
#include "support/command_on_file.hpp"
#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::app::calib {
namespace {

using testing::CommandResult;
using testing::TemporaryFolder;

Board charuco(int columns, int rows) {
  Board board;
  board.kind = BoardKind::charuco;
  board.columns = columns, board.rows = rows;
  board.square_m = 0.24 / std::max(columns, rows);
  board.marker_m = 0.75 * board.square_m;
  board.dictionary = "4x4_250";
  return board;
}

/// Photographs of a board from five sides, the last two of parts of it.
void draw(const TemporaryFolder& folder, const Board& board, int dictionary, int bits,
          bool is_legacy = false) {
  const testing::Viewer viewer;
  const auto picture = testing::charucoPicture(board, dictionary, bits, is_legacy);
  int number = 0;
  for (const auto& [x, y, aside] :
       {std::tuple(0.05, 0.1, 0.), {0.5, 0.1, 0.}, {-0.4, 0.3, 0.02}, {0.2, -0.5, 0.1}, {-0.3, 0.4, -0.1}}) {
    const SE3 place = testing::placed(board, vec3(aside, 0.02, 0.36), x, y, 0.3 * x);
    ++number;
    testing::writePgm(folder / fmt::format("p{}.pgm", number),
                      viewer.photograph(place, picture, unsigned(number)));
  }
}

CommandResult calibrate(const TemporaryFolder& folder, const std::string& board) {
  CommandResult result = testing::runCalibrate({"--board", board, "--square", "0.03", "--marker", "0.0225",
                                                "--images", "cam=" + (folder / "p*.pgm").string(), "--output",
                                                (folder / "c.yaml").string(), "--quiet"});
  result.errors = slom::testing::replaced(result.errors, folder.path().string() + "/", "");
  return result;
}

void expectAnswer(const TemporaryFolder& folder, const std::string& given, const std::string& sentence) {
  std::filesystem::remove(folder / "c.yaml");
  const CommandResult result = calibrate(folder, given);
  EXPECT_EQ(result.exit_code, 2) << given;
  EXPECT_EQ(result.errors, "slom: " + sentence + "\n") << given;
  EXPECT_FALSE(std::filesystem::exists(folder / "c.yaml")) << given;
}

TEST(MarkerLayout, OfABoardOfAnotherSizeIsNamed) {
  for (const auto& [columns, rows] : {std::pair(8, 5), {7, 10}, {6, 6}, {11, 8}}) {
    if (slom::testing::hasSanitizers() && columns != 8) continue;
    const TemporaryFolder folder;
    draw(folder, charuco(columns, rows), cv::aruco::DICT_4X4_250, 4);
    const std::string truth = fmt::format("{}x{}", columns, rows);
    EXPECT_EQ(calibrate(folder, "charuco:" + truth + ":4x4_250").errors, "") << truth;
    for (const auto& [c, r] :
         {std::pair(rows, columns), {columns + 1, rows + 1}, {columns - 1, rows}, {columns + 2, rows - 1}}) {
      if (c == columns) continue;
      expectAnswer(
          folder, fmt::format("charuco:{}x{}:4x4_250", c, r),
          fmt::format("p1.pgm: the markers match a board of {0}; give --board charuco:{0}:4x4_250", truth));
    }
  }
}

TEST(MarkerLayout, AnotherDictionaryIsNamed) {
  const TemporaryFolder folder;
  draw(folder, charuco(7, 5), cv::aruco::DICT_5X5_100, 5);
  expectAnswer(folder, "charuco:7x5:4x4_50",
               "p1.pgm: the markers belong to the dictionary 5x5_50 and match a board of 7x5; give --board "
               "charuco:7x5:5x5_50");
}

TEST(MarkerLayout, ThePatternBeforeOpenCv46IsNamed) {
  const TemporaryFolder folder;
  draw(folder, charuco(7, 6), cv::aruco::DICT_4X4_50, 4, true);
  expectAnswer(
      folder, "charuco:7x6:4x4_50",
      "p1.pgm: the markers match a board of 7x6 whose upper left square is white, as printed by OpenCV "
      "before 4.6; print the board again with OpenCV 4.6 or later");
}

/// Finds the layout from ids and centres only: from few markers, with noise and misread markers, over sizes and seeds.
TEST(MarkerLayout, IsFoundFromPartsOfBoards) {
  const unsigned boards = slom::testing::hasSanitizers() ? 3 : 40;
  for (unsigned seed = 1; seed <= boards; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<>(low, high)(random);
    };
    const Board board = charuco(int(uniform(6, 14)), int(uniform(6, 14)));
    const testing::Viewer viewer;
    std::vector<std::vector<SeenMarker>> photos(5);
    for (auto& markers : photos) {
      const SE3 place = testing::placed(board, vec3(uniform(-0.05, 0.05), uniform(-0.05, 0.05), 0.4),
                                        uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5));
      int id = 0;
      for (int k = 0; k < board.columns * board.rows; ++k) {
        const int column = k % board.columns, row = k / board.columns;
        if ((column + row) % 2 == 0) continue;
        const vec3 centre(board.square_m * (column - 0.5), board.square_m * (row - 0.5), 0.);
        const vec2 pixel(viewer.project(place, centre) + vec2(uniform(-0.5, 0.5), uniform(-0.5, 0.5)));
        if (uniform(0, 1) < 0.7 || row == board.rows - 1) markers.push_back({id, pixel});
        ++id;
      }
      markers.push_back({int(uniform(0, 49)), vec2(uniform(0, 640), uniform(0, 480))});
    }
    const MarkerLayout found = likeliestLayout(photos);
    EXPECT_EQ(found.columns, board.columns) << seed << " " << toString(board);
    EXPECT_EQ(found.rows, board.rows) << seed << " " << toString(board);
    EXPECT_FALSE(found.is_legacy) << seed;
    if (board.columns != board.rows) {
      EXPECT_LT(2 * found.misfit, misfitOf({board.rows, board.columns}, photos)) << seed;
    }
  }
}

}  // namespace
}  // namespace slom::app::calib
