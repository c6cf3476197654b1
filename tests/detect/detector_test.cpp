// Detected corners, compared with the drawn positions.
#include "calibrate/detect/detector.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "detect/rendered_markers.hpp"

namespace slom::app::calib {
namespace {

using testing::bitsOf;
using testing::charucoPicture;
using testing::chessboard;
using testing::chessboardPicture;
using testing::placed;
using testing::Viewer;

constexpr double quarter = std::numbers::pi / 2;

/// Largest distance of the corners from the truth, the ones with the same index compared [px].
double worst(const Viewer& viewer, const Board& board, const SE3& board2camera,
             const std::vector<FoundCorner>& found) {
  double distance = 0;
  for (const FoundCorner& corner : found)
    distance =
        std::max(distance, (viewer.project(board2camera, board.corner(corner.index)) - corner.pixel).norm());
  return distance;
}

/// Places that a calibration has: near, far, tilted to all sides, turned.
std::vector<SE3> places(const Board& board) {
  std::vector<SE3> result;
  for (const double turn : {0.0, 0.3, -0.4}) {
    for (const auto& [x, y] : {std::pair(0., 0.), {0.6, 0.1}, {-0.5, 0.3}, {0.2, -0.6}, {-0.1, 0.5}})
      result.push_back(placed(board, vec3(0.02 * x, -0.03 * y, 0.45 + 0.1 * std::abs(x)), x, y, turn));
  }
  return result;
}

TEST(Chessboard, CornersAreWhereTheyWereDrawn) {
  const Board board = chessboard(9, 6);
  const Viewer viewer;
  double square = 0;
  int count = 0;
  for (const SE3& place : places(board)) {
    const auto found = findBoard(board, viewer.photograph(place, chessboardPicture(board)));
    ASSERT_EQ(found.size(), 54u);
    EXPECT_LT(worst(viewer, board, place, found), 0.1);
    for (const FoundCorner& corner : found)
      square += (viewer.project(place, board.corner(corner.index)) - corner.pixel).squaredNorm(), ++count;
  }
  EXPECT_LT(std::sqrt(square / count), 0.05);
}

TEST(Chessboard, BeginsAtTheSameEndHoweverItIsTurned) {
  const Viewer viewer;
  for (const auto& [columns, rows] : {std::pair(9, 6), {6, 9}, {8, 5}, {5, 5}}) {
    const Board board = chessboard(columns, rows, 0.025);
    for (int quarters = 0; quarters < 4; ++quarters) {
      const SE3 place = placed(board, vec3(0., 0., 0.5), 0.2, -0.1, quarters * quarter + 0.1);
      const auto found = findBoard(board, viewer.photograph(place, chessboardPicture(board)));
      ASSERT_EQ(found.size(), std::size_t(columns * rows));
      // 5 x 5 looks the same upside down.
      const SE3 half_turned =
          place * SE3(SO3::exp(vec3(0., 0., 2 * quarter)), board.corner(columns * rows - 1));
      const double either =
          std::min(worst(viewer, board, place, found), worst(viewer, board, half_turned, found));
      EXPECT_LT(board.symmetry() == 1 ? worst(viewer, board, place, found) : either, 0.1)
          << toString(board) << " turned " << quarters;
    }
  }
}

TEST(Chessboard, SymmetricBoardsBeginAtTheUpperLeft) {
  const Viewer viewer;
  for (const auto& [columns, rows] : {std::pair(8, 6), {7, 5}, {6, 6}, {5, 5}}) {
    const Board board = chessboard(columns, rows, 0.025);
    for (int quarters = 0; quarters < 4; ++quarters) {
      const SE3 place = placed(board, vec3(0., 0., 0.5), 0.2, -0.1, quarters * quarter + 0.1);
      const auto found = findBoard(board, viewer.photograph(place, chessboardPicture(board)));
      ASSERT_EQ(found.size(), std::size_t(columns * rows));
      EXPECT_LT(found.front().pixel.sum(), found.back().pixel.sum())
          << toString(board) << " turned " << quarters;
    }
  }
}

TEST(Chessboard, IsFoundInLargePhotographsToo) {
  const Board board = chessboard(9, 6);
  Viewer viewer;
  viewer.camera = {3500, 3500, 1620, 1190};
  viewer.size = {3240, 2400};
  const SE3 place = placed(board, vec3(0., 0., 0.5), 0.4, -0.3, 0.2);
  const auto found = findBoard(board, viewer.photograph(place, chessboardPicture(board)));
  ASSERT_EQ(found.size(), 54u);
  EXPECT_LT(worst(viewer, board, place, found), 0.1);
}

TEST(Chessboard, NoneIsFoundWhereThereIsNone) {
  const Viewer viewer;
  const Board board = chessboard(9, 6);
  EXPECT_TRUE(
      findBoard(board, viewer.photograph(placed(board, vec3(0., 0., 0.5), 0, 0, 0), [](double, double) {
        return 0.5;
      })).empty());
  const auto smaller =
      viewer.photograph(placed(board, vec3(0., 0., 0.5), 0, 0, 0), chessboardPicture(chessboard(8, 6)));
  EXPECT_TRUE(findBoard(board, smaller).empty());
}

TEST(Charuco, CornersAreWhereTheyWereDrawn) {
  Board board;
  board.kind = BoardKind::charuco;
  board.columns = 8;
  board.rows = 6;
  board.square_m = 0.04;
  board.marker_m = 0.03;
  board.dictionary = "5x5_100";
  const Viewer viewer;
  for (const SE3& place : places(board)) {
    const auto found = findBoard(board, viewer.photograph(place, charucoPicture(board)));
    EXPECT_GT(found.size(), 25u);
    EXPECT_LT(worst(viewer, board, place, found), 0.15);
  }
  // A part of it is enough.
  const SE3 aside = placed(board, vec3(0.2, 0., 0.5), 0.3, 0.2, 0.1);
  const auto found = findBoard(board, viewer.photograph(aside, charucoPicture(board)));
  EXPECT_GT(found.size(), 6u);
  EXPECT_LT(found.size(), 30u);
  EXPECT_LT(worst(viewer, board, aside, found), 0.15);
}

/// Tags by rows from the lower left, a small black square between any four; `quarters`: how far each tag is
/// turned.
testing::Picture aprilgridPicture(const Board& board, int quarters) {
  std::vector<std::vector<std::vector<int>>> tags;
  for (int id = 0; id < board.columns * board.rows; ++id)
    tags.push_back(bitsOf(cv::aruco::DICT_APRILTAG_36h11, id, 6, 2));
  return [=](double x, double y) {
    const double pitch = 1 + board.spacing, u = x / board.square_m, v = y / board.square_m;
    const int column = int(std::floor(u / pitch)), row = int(std::floor(v / pitch));
    const double i = u - column * pitch, j = v - row * pitch;
    if (i > 1 && j > 1)
      return column >= -1 && row >= -1 && column < board.columns && row < board.rows ? 0.05 : 0.95;
    if (i > 1 || j > 1 || column < 0 || row < 0 || column >= board.columns || row >= board.rows) return 0.95;
    int bit_column = std::min(9, int(i * 10)),
        bit_row = 9 - std::min(9, int(j * 10));  // rows of a tag run down
    for (int k = 0; k < quarters; ++k) bit_column = std::exchange(bit_row, 9 - bit_column);
    return tags[std::size_t(row * board.columns + column)][std::size_t(bit_row)][std::size_t(bit_column)]
               ? 0.95
               : 0.05;
  };
}

TEST(Aprilgrid, CornersAreWhereTheyWereDrawn) {
  Board board;
  board.kind = BoardKind::aprilgrid;
  board.columns = 5;
  board.rows = 4;
  board.square_m = 0.05;
  board.spacing = 0.3;
  const Viewer viewer;
  const SE3 upright(SO3::exp(vec3(2 * quarter, 0., 0.)), vec3());  // y up and z to the camera
  const auto all = places(board);
  for (int quarters = 0; quarters < 4; ++quarters) {
    for (std::size_t i = std::size_t(quarters); i < all.size(); i += 4) {
      const SE3& place = all[i];
      const vec3 last = board.corner(board.cornerCount() - 1);
      const SE3 turned(place.orient * upright.orient,
                       vec3(place * vec3(last / 2) - place.orient * (upright.orient * vec3(last / 2))));
      const auto found = findBoard(board, viewer.photograph(turned, aprilgridPicture(board, quarters)));
      EXPECT_GT(found.size(), 60u);
      for (const FoundCorner& corner : found)
        EXPECT_LT((viewer.project(turned, board.corner(corner.index)) - corner.pixel).norm(), 0.15)
            << "place " << i << ", corner " << corner.index << " at " << corner.pixel.transpose();
    }
  }
}

}  // namespace
}  // namespace slom::app::calib
