// Views that show the board mirrored among views from its front: they are named, and no other view is. Seeds are fixed.
#include "calibration/procedure/mirrored_views.hpp"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"
#include "calibration/models/fisheye.hpp"
#include "calibration/simulated_rig.hpp"

namespace slom::app::calib {
namespace {

using testing::RigOptions;

/// Boards of 9 x 6 corners, seen by a rig.
Dataset boardsFromTheFront(unsigned seed, int cameras = 1, int images = 12) {
  RigOptions options;
  options.cameras = cameras;
  options.images = images;
  options.columns = 9, options.rows = 6;
  options.square_m = 0.03;
  std::mt19937_64 random(seed);
  const testing::RigTruth truth = testing::simulateTruth(options, random);
  Dataset data = testing::simulateMeasurements(truth, options, random);
  data.imu.reset();
  return data;
}

void exchangeUAndV(View& view) {
  for (Corner& corner : view.corners) std::swap(corner.pixel.x(), corner.pixel.y());
}

/// Numbers the corners from the other end of each row.
void mirrorRows(View& view) {
  for (Corner& corner : view.corners) corner.world.x() = 0.03 * 8 - corner.world.x();
}

std::vector<int> imagesOf(const std::vector<Stray>& strays) {
  std::vector<int> images;
  for (const Stray& stray : strays) images.push_back(stray.image);
  return images;
}

TEST(MirroredViews, AreLeftOutAndNamed) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Dataset data = boardsFromTheFront(seed);
    auto& views = data.cameras[0].views;
    exchangeUAndV(views[4]);
    mirrorRows(views[7]);
    const Result result = calibrate(data, Settings());
    ASSERT_TRUE(result.success()) << seed << " " << result.message;
    ASSERT_EQ(imagesOf(result.strays), (std::vector<int>{views[4].image, views[7].image})) << seed;
    for (const Stray& stray : result.strays) {
      EXPECT_TRUE(stray.is_left_out && stray.is_mirrored) << seed;
      EXPECT_EQ(stray.why,
                "the board is mirrored, because u and v are exchanged or corners are numbered from a "
                "mirrored corner");
    }
    EXPECT_EQ(result.images.size(), views.size() - 2) << seed;
    EXPECT_NEAR(result.cameras[0].parameters[0].value, 600, 12) << seed;
  }
}

TEST(MirroredViews, AreComparedWithinTheirCamera) {
  Dataset data = boardsFromTheFront(1, 2);
  for (View& view : data.cameras[1].views) mirrorRows(view);
  EXPECT_TRUE(mirroredViews(data).empty());
  mirrorRows(data.cameras[1].views[2]);
  const std::vector<Stray> mirrored = mirroredViews(data);
  ASSERT_EQ(mirrored.size(), 1u);
  EXPECT_EQ(mirrored[0].camera, data.cameras[1].name);
  EXPECT_EQ(mirrored[0].image, data.cameras[1].views[2].image);
}

TEST(MirroredViews, NoneIsNamedWithoutAClearMajority) {
  Dataset data = boardsFromTheFront(2);
  auto& views = data.cameras[0].views;
  ASSERT_EQ(views.size(), 12u);
  for (std::size_t i = 0; i < 4; ++i) mirrorRows(views[i]);
  EXPECT_TRUE(mirroredViews(data).empty());
  mirrorRows(views[0]);
  EXPECT_EQ(mirroredViews(data).size(), 3u);
  views.erase(views.begin() + 4, views.end());
  views.erase(views.begin());  // one of three from the front
  EXPECT_TRUE(mirroredViews(data).empty());
}

TEST(MirroredViews, NoneIsNamedOfABoardThatIsNotFlat) {
  Dataset data = boardsFromTheFront(3);
  mirrorRows(data.cameras[0].views[5]);
  ASSERT_EQ(mirroredViews(data).size(), 1u);
  for (View& view : data.cameras[0].views) {
    for (Corner& corner : view.corners) corner.world.z() = 2 * std::pow(corner.world.x() - 0.12, 2);
  }
  EXPECT_TRUE(mirroredViews(data).empty());
}

/// Turned about the vertical by up to 89 degrees, a board has the handedness of its front or none, for any lens.
TEST(MirroredViews, ABoardSeenFromTheFrontIsNeverTakenForAMirroredOne) {
  constexpr double degrees = std::numbers::pi / 180;
  CameraResult lens;
  lens.model = "fisheye";
  const double f = 640 / (85 * degrees);
  const std::vector<double> values{f, f, 640, 480, 0.02, -0.006, 0.001, -0.0003};
  for (std::size_t i = 0; i < values.size(); ++i)
    lens.parameters.push_back({Model("fisheye").parameters()[i], values[i], 1});
  std::vector<Corner> all;
  for (int k = 0; k < 54; ++k) all.push_back({k + 1, vec3(0.03 * (k % 9), 0.03 * (k / 9), 0.), vec2(0., 0.)});
  const BoardPlane plane = fitPlane(all);
  const bool is_turned = Eigen::Vector3d(plane.plane2world.orient * vec3(0., 0., 1.)).z() < 0;
  std::mt19937_64 random(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  std::normal_distribution<> normal;
  int right = 0, views = 0;
  for (int i = 0; i < 3000; ++i) {
    const double away = 85 * degrees * std::sqrt(uniform(0, 1)), around = uniform(0, 2 * std::numbers::pi);
    const SO3 aim = SO3::exp(vec3(-std::sin(around) * away, std::cos(around) * away, 0.));
    const double tilt = uniform(0, 89 * degrees), axis = uniform(0, 2 * std::numbers::pi);
    const SO3 turn = SO3::exp(vec3(tilt * std::cos(axis), tilt * std::sin(axis), 0.)) *
                     SO3::exp(vec3(0., 0., uniform(-3, 3)));
    const vec3 centre(aim * vec3(0., 0., uniform(0.1, 0.6)));
    View view;
    for (int k = 0; k < 54; ++k) {
      const vec3 world(0.03 * (k % 9), 0.03 * (k / 9), 0.);
      const vec3 point(aim * (turn * vec3(world - vec3(0.12, 0.075, 0.))) + centre);
      const bool is_seen = std::atan2(std::hypot(point.x(), point.y()), point.z()) < 85 * degrees;
      // A part of the board that lies behind the camera's centre is seen from its back.
      const bool is_front = Eigen::Vector3d(turn.inverse() * (aim.inverse() * point)).z() > 0;
      if (is_seen && is_front)
        view.corners.push_back(
            {k + 1, world, vec2(lens.project(point) + 0.3 * vec2(normal(random), normal(random)))});
    }
    if (view.corners.size() < 6) continue;
    const Handedness handedness = handednessOf(view, plane);
    EXPECT_NE(handedness, is_turned ? Handedness::right : Handedness::left)
        << i << " tilt " << tilt / degrees;
    right += handedness == (is_turned ? Handedness::left : Handedness::right) ? 1 : 0;
    ++views;
  }
  EXPECT_GT(right, views / 2);
}

TEST(MirroredViews, TheCommandNamesTheImageAndEndsWith1) {
  Dataset data = boardsFromTheFront(5);
  exchangeUAndV(data.cameras[0].views[4]);
  const auto result = testing::runWithUnusableResult(data.cameras[0]);
  EXPECT_NE(result.errors.find(
                "image cam.5 contradicts the others: the board is mirrored, because u and v are exchanged or "
                "corners are numbered from a mirrored corner; correct it or leave it out by --exclude"),
            std::string::npos)
      << result.errors;
  EXPECT_NE(result.output.find("Image 5 of camera cam contradicts the others: the board is mirrored"),
            std::string::npos)
      << result.output;
}

}  // namespace
}  // namespace slom::app::calib
