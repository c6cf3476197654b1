// The predicted gain of a next best view equals the gain of a fit with that view.
#include "calibration/quality/verdict/next_best_view.hpp"

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/quality/calibrated_rig.hpp"

namespace slom::calibration {
namespace {

constexpr double distance_m = 0.7;

std::vector<FurtherView> viewsOf(const testing::CalibratedRig& r) {
  const FittedRig rig(r.result);
  FurtherViewOptions options;
  options.board_distance_m = distance_m;
  return furtherViews(rig, testing::informationOfAll(r.data, rig), fullestView(r.data),
                      testing::grids(r.data, 33, 25), options);
}

double worstOf(const Dataset& data, const Result& result) {
  const FittedRig rig(result);
  return worstStd(pointsOfAllCameras(rig, testing::grids(data, 7, 5), distance_m),
                  Posterior(testing::informationOfAll(data, rig)));
}

/// Adds the images of the board that the true rig takes from the requested view.
void takeView(testing::CalibratedRig& r, const testing::RigOptions& options, const FurtherView& view,
              int image, std::mt19937_64& random) {
  testing::RigTruth truth = r.truth;
  truth.left2world = {{image, view.left2world}};
  const Dataset more = testing::measured(truth, options, random, false);
  for (std::size_t c = 0; c < r.data.cameras.size(); ++c) {
    for (const View& seen : more.cameras[c].views) r.data.cameras[c].views.push_back(seen);
  }
}

/// Takes the views one after the other and calibrates anew.
void expectGain(const testing::RigOptions& options, unsigned seed, double tolerance) {
  Settings settings = testing::opencv4();
  if (options.sigma_px > 0) settings.sigma_px = options.sigma_px;
  testing::CalibratedRig r = testing::calibratedRig(options, settings, seed);
  std::mt19937_64 random(100 + seed);
  const std::vector<FurtherView> views = viewsOf(r);
  ASSERT_EQ(views.size(), 3u);
  EXPECT_NEAR(views[0].before_px, worstOf(r.data, r.result), 1e-9);
  int image = 100;
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_LT(views[i].after_px, views[i].before_px);
    EXPECT_EQ(views[i].before_px, i == 0 ? views[i].before_px : views[i - 1].after_px);
    takeView(r, options, views[i], ++image, random);
    r.result = calibrate(r.data, r.settings);
    ASSERT_TRUE(r.result.success());
    EXPECT_NEAR(worstOf(r.data, r.result) / views[i].after_px, 1, tolerance)
        << "seed " << seed << ", view " << i << ": from " << views[i].before_px << " to "
        << views[i].after_px;
  }
}

/// Without noise the values do not change, so the gain is exact.
TEST(FurtherViews, BringExactlyWhatIsPredictedWithoutNoise) {
  testing::RigOptions options = testing::smallBoards();
  options.sigma_px = 0;
  for (const unsigned seed : {11u, 12u, 13u}) expectGain(options, seed, 1e-4);
}

/// With it the values move, and the derivatives with them, by a part that is proportional to the noise.
TEST(FurtherViews, BringWhatIsPredicted) {
  testing::RigOptions options = testing::smallBoards();
  options.images = 16;
  options.sigma_px = 0.05;
  for (const unsigned seed : {11u, 12u, 13u}) expectGain(options, seed, 0.12);
}

/// Centre of the board in the image, and whether the edge that is said to be farther away is.
TEST(FurtherViews, AreWhereTheWordsSay) {
  const testing::CalibratedRig r = testing::calibratedRig(testing::smallBoards(), testing::opencv4(), 14);
  const FittedRig rig(r.result);
  const BoardOutline board = outlineOf(fullestView(r.data));
  for (const FurtherView& view : viewsOf(r)) {
    const SE3 board2camera = rig.left2camera[view.camera] * view.left2world.inverse() * board.board2world;
    EXPECT_LT((rig.lenses[view.camera].project(board2camera.pos) - view.pixel).norm(), 1e-3);
    EXPECT_NEAR(board2camera.pos.norm(), view.distance_m, 1e-9);
    const vec3 normal = board2camera.orient * vec3(0., 0., 1.);
    EXPECT_NEAR(std::abs(normal.z()), std::cos(view.tilt_deg * M_PI / 180), 1e-9);
    // The depth of the plane grows towards the edge that is farther away.
    const vec2 slope(-normal.x() / normal.z(), -normal.y() / normal.z());
    const std::map<std::string, double> slopes{
        {"right", slope.x()}, {"left", -slope.x()}, {"lower", slope.y()}, {"upper", -slope.y()}};
    EXPECT_TRUE(view.edge_away.empty() || slopes.at(view.edge_away) > 0.5) << view.edge_away;
  }
}

TEST(FurtherViews, InWords) {
  Result result;
  result.cameras.resize(2);
  result.cameras[1].name = "right";
  FurtherView view;
  view.camera = 1;
  view.tilt_deg = 40;
  view.edge_away = "left";
  view.distance_m = 0.6;
  view.before_px = 1.1;
  view.after_px = 0.7;
  EXPECT_EQ(sentenceOf(view, result),
            "a board tilted by 40 degrees, its left edge farther away, in the upper left of the image of "
            "right, at 0.60 m: from 1.1 to 0.70 px");
  view.edge_away = "";
  view.column = view.row = 1;
  EXPECT_EQ(sentenceOf(view, result),
            "a board facing the camera, in the middle of the image of right, at 0.60 m: from 1.1 to 0.70 px");
}

}  // namespace
}  // namespace slom::calibration
