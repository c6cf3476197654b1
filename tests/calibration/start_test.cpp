// Start values against simulated truth: exact without noise and distortion, near it otherwise.
#include <numbers>
#include <random>
#include <regex>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/initialization/imu.hpp"
#include "calibration/initialization/intrinsics.hpp"
#include "calibration/initialization/parallel_views.hpp"
#include "calibration/initialization/rig.hpp"
#include "calibration/initialization/view_pose.hpp"
#include "calibration/simulated_rig.hpp"

namespace slom::calibration {
namespace {

using testing::angleBetween;
using testing::RigOptions;
using testing::RigTruth;

struct Simulated {
  RigTruth truth;
  Dataset data;
};

Simulated simulate(const RigOptions& options, unsigned seed) {
  std::mt19937_64 random(seed);
  Simulated s;
  s.truth = testing::simulateTruth(options, random);
  s.data = testing::simulateMeasurements(s.truth, options, random);
  return s;
}

RigOptions ideal() {
  RigOptions options;
  options.distorted = false;
  options.sigma_px = options.sigma_acc = 0;
  return options;
}

std::vector<Eigen::Matrix3d> homographiesOf(const CameraData& camera) {
  std::vector<Eigen::Matrix3d> result;
  for (const PlaneView& view : planeViews(camera)) result.push_back(view.homography);
  return result;
}

TEST(Homography, MapsBoardToPixels) {
  const Simulated s = simulate(ideal(), 1);
  for (const PlaneView& view : planeViews(s.data.cameras[0])) {
    for (std::size_t i = 0; i < view.board.size(); ++i) {
      const Eigen::Vector3d q = view.homography * view.board[i].homogeneous();
      EXPECT_GT(q.z(), 0);
      EXPECT_LT((q.hnormalized() - view.pixels[i]).norm(), 1e-9);
    }
  }
}

TEST(Homography, FourCornersAreEnough) {
  const std::vector<vec2> board{{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}},
      pixels{{10., 20.}, {110., 25.}, {100., 130.}, {5., 90.}};
  const Eigen::Matrix3d H = findHomography(board, pixels);
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(((H * board[i].homogeneous()).hnormalized() - pixels[i]).norm(), 1e-10);
}

TEST(Zhang, IsExactOnIdealViews) {
  const Simulated s = simulate(ideal(), 2);
  for (std::size_t c = 0; c < 2; ++c) {
    const auto p = zhang(homographiesOf(s.data.cameras[c]));
    ASSERT_TRUE(p);
    EXPECT_NEAR(p->fx, s.truth.cameras[c][0], 1e-6);
    EXPECT_NEAR(p->fy, s.truth.cameras[c][1], 1e-6);
    EXPECT_NEAR(p->cx, s.truth.cameras[c][2], 1e-6);
    EXPECT_NEAR(p->cy, s.truth.cameras[c][3], 1e-6);
  }
}

TEST(Zhang, IsNearTheTruthWithNoiseAndDistortion) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Simulated s = simulate(RigOptions{}, seed);
    const IntrinsicsStart start = startIntrinsics(planeViews(s.data.cameras[0]));
    EXPECT_NEAR(start.pinhole.fx, s.truth.cameras[0][0], 60) << "seed " << seed;
    EXPECT_NEAR(start.pinhole.cx, s.truth.cameras[0][2], 60) << "seed " << seed;
  }
}

TEST(Zhang, ParallelBoardsAreLeftToTheFallback) {
  RigOptions options = ideal();
  options.images = 2;
  Simulated s = simulate(options, 3);
  for (auto& [image, pose] : s.truth.left2world) {  // both straight from above
    pose = SE3(SO3::exp(vec3(M_PI, 0., 0.)), vec3(0.17, 0.12, 0.5 + 0.1 * image));
  }
  std::mt19937_64 random(1);
  s.data = testing::simulateMeasurements(s.truth, options, random);
  const IntrinsicsStart start = startIntrinsics(planeViews(s.data.cameras[0]));
  EXPECT_GT(start.pinhole.fx, 50);
  EXPECT_NEAR(start.pinhole.cx, 320, 320);
}

constexpr double degree = std::numbers::pi / 180;

/// Six views of a board that is turned and moved, but always tilted by the same angle about the camera's x
/// axis; the last one by `more`.
std::vector<PlaneView> equallyTilted(double tilt_deg, double more_deg, double sigma_px) {
  RigOptions options = ideal();
  options.cameras = 1;
  options.sigma_px = sigma_px;
  std::mt19937_64 random(4);
  RigTruth truth = testing::simulateTruth(options, random);
  truth.left2world.clear();
  for (int image = 1; image <= 6; ++image) {
    const SO3 lean = SO3::exp(vec3(degree * (tilt_deg + (image == 6 ? more_deg : 0)), 0., 0.));
    const SO3 board2camera = lean * SO3::exp(vec3(0., 0., 0.4 * image)) * SO3::exp(vec3(M_PI, 0., 0.));
    const vec3 centre(0.175, 0.125, 0.),
        centre_in_camera(0.02 * image - 0.07, 0.05 - 0.01 * image, 0.7 + 0.05 * image);
    truth.left2world[image] = SE3(board2camera, vec3(centre_in_camera - board2camera * centre)).inverse();
  }
  return planeViews(testing::simulateMeasurements(truth, options, random).cameras[0]);
}

TEST(ParallelViews, HaveTheSameNormalWhateverTheirTilt) {
  for (const double tilt : {0.0, 20.0, 40.0}) {
    EXPECT_LT(normalSpread(equallyTilted(tilt, 0, 0)), 1e-9) << tilt;
    EXPECT_GT(normalSpread(equallyTilted(tilt, 10, 0)), 4 * degree) << tilt;
  }
}

TEST(ParallelViews, AreKnownBeforeTheFit) {
  for (const double tilt : {0.0, 20.0, 40.0}) {
    const auto parallel = equallyTilted(tilt, 0, 0.1), other = equallyTilted(tilt, 10, 0.1);
    ASSERT_EQ(parallel.size(), 6u);
    const std::regex sentence(
        "all 6 images show the board at the same tilt, within (0\\.\\d+|1(\\.\\d)?) degrees, which leaves "
        "the focal length open");
    EXPECT_TRUE(std::regex_match(parallelViews({parallel}, 6), sentence)) << parallelViews({parallel}, 6);
    EXPECT_TRUE(std::regex_match(parallelViews({parallel, parallel}, 6), sentence));
    EXPECT_EQ(parallelViews({other}, 6), "") << tilt;
    EXPECT_EQ(parallelViews({parallel, other}, 6), "") << "one camera that sees another tilt is enough";
  }
}

TEST(ViewPose, IsExactOnIdealViewsOfAnyPlane) {
  RigOptions options = ideal();
  Simulated s = simulate(options, 4);
  const SE3 moved(SO3::exp(vec3(0.4, 1.1, -0.3)),
                  vec3(2., -1., 5.));  // the board's plane somewhere in the world
  const Pinhole camera{s.truth.cameras[0][0], s.truth.cameras[0][1], s.truth.cameras[0][2],
                       s.truth.cameras[0][3]};
  for (View view : s.data.cameras[0].views) {
    const SE3 truth = s.truth.left2world[view.image].inverse() * moved.inverse();
    for (Corner& corner : view.corners) corner.world = moved * corner.world;
    const PlaneView plane(view);
    const SE3 pose = poseFromHomography(plane, camera);
    EXPECT_LT(angleBetween(pose.orient, truth.orient), 1e-9);
    EXPECT_LT((pose.pos - truth.pos).norm(), 1e-8);
    EXPECT_LT(squaredPixelError(plane, camera, pose), 1e-12);
  }
}

TEST(ViewPose, TiltedTheOtherWayIsItsOwnInverseAndLooksSimilarFromAfar) {
  RigOptions options = ideal();
  options.focal_length = 20000;
  options.distance = 25;
  const Simulated s = simulate(options, 5);
  const auto& c = s.truth.cameras[0];
  const Pinhole camera{c[0], c[1], c[2], c[3]};
  for (const View& v : s.data.cameras[0].views) {
    const PlaneView view(v);
    const SE3 pose = s.truth.left2world.at(v.image).inverse(), other = tiltedOtherWay(view, pose);
    EXPECT_GT(angleBetween(pose.orient, other.orient), 0.3);
    EXPECT_LT(angleBetween(pose.orient, tiltedOtherWay(view, other).orient), 1e-9);
    EXPECT_LT(std::sqrt(squaredPixelError(view, camera, other) / double(view.board.size())), 3);
  }
}

ViewPoses truePoses(const Simulated& s, std::size_t camera) {
  ViewPoses poses;
  for (const View& view : s.data.cameras[camera].views) {
    poses[view.image] = s.truth.left2camera[camera] * s.truth.left2world.at(view.image).inverse();
  }
  return poses;
}

TEST(Rig, TiesCamerasThroughOthersAndOutvotesABadPose) {
  RigOptions options = ideal();
  options.cameras = 3;
  options.images = 9;
  Simulated s = simulate(options, 6);
  const auto keep = [](CameraData& camera, int first, int last) {
    std::erase_if(camera.views, [&](const View& v) { return v.image < first || v.image > last; });
  };
  keep(s.data.cameras[0], 1, 4);  // camera a shares nothing with camera c
  keep(s.data.cameras[2], 5, 9);
  std::vector<ViewPoses> poses{truePoses(s, 0), truePoses(s, 1), truePoses(s, 2)};
  poses[1][2] = SE3(SO3::exp(vec3(0.5, 0., 0.)), vec3(0.1, 0.1, 0.1)) * poses[1][2];
  const RigStart rig = startRig(s.data, poses);
  ASSERT_EQ(rig.left2camera.size(), 3u);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT(angleBetween(rig.left2camera[c].orient, s.truth.left2camera[c].orient), 1e-9);
    EXPECT_LT((rig.left2camera[c].pos - s.truth.left2camera[c].pos).norm(), 1e-9);
  }
  ASSERT_EQ(rig.left2world.size(), 9u);
  for (const auto& [image, pose] : rig.left2world) {
    EXPECT_LT(angleBetween(pose.orient, s.truth.left2world.at(image).orient), 1e-9) << image;
    EXPECT_LT((pose.pos - s.truth.left2world.at(image).pos).norm(), 1e-9) << image;
  }
}

TEST(Rig, PosesThatAreNotFiniteHaveNoVote) {
  RigOptions options = ideal();
  options.images = 4;
  Simulated s = simulate(options, 6);
  s.data.cameras[1].file = "b.csv";
  std::vector<ViewPoses> poses{truePoses(s, 0), truePoses(s, 1)};
  poses[1].begin()->second.pos[0] = NAN;
  const RigStart rig = startRig(s.data, poses);
  EXPECT_LT((rig.left2camera[1].pos - s.truth.left2camera[1].pos).norm(), 1e-9);
  for (auto& [image, pose] : poses[1]) pose.pos[0] = NAN;
  try {
    startRig(s.data, poses);
    FAIL() << "no error";
  } catch (const DataError& error) {
    EXPECT_EQ(error.sentence(),
              "b.csv: 4 images that camera b shares with camera a give no finite pose between the two; "
              "look for corners and "
              "world points that are wrong");
  }
}

class ImuStartTest : public ::testing::TestWithParam<std::tuple<bool, double>> {};

TEST_P(ImuStartTest, FindsRotationAndSign) {
  RigOptions options;
  options.z_down = std::get<0>(GetParam());
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    RigTruth truth = testing::simulateTruth(options, random);
    truth.gravity = std::get<1>(GetParam());
    const Dataset data = testing::simulateMeasurements(truth, options, random);
    const ImuStart start = startImu(tiltPairs(*data.imu, truth.left2world), {}, options.sigma_acc);
    EXPECT_NEAR(start.gravity, truth.gravity, 0.2);
    EXPECT_LT(angleBetween(start.left2imu, truth.left2imu), 0.05);
    EXPECT_GT(start.sign_evidence, 100);
  }
}
INSTANTIATE_TEST_SUITE_P(BothBoardsAndBothSensors, ImuStartTest,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(9.81, -9.81)));

TEST(ImuStart, SaysThatTiltsAboutOneAxisLeaveTheSignOpen) {
  std::vector<TiltPair> pairs;
  for (int i = -3; i <= 3; ++i) {
    const vec3 up = SO3::exp(vec3(0.1 * i, 0., 0.)) * vec3(0., 0., 1.);
    pairs.push_back({up, vec3(9.81 * up)});
  }
  EXPECT_LT(startImu(pairs, {}, 0.05).sign_evidence, 1e-6);
}

TEST(ImuStart, PrecisionIsThatOfRepeatedFits) {
  // Linear least squares, repeated with new noise, against the predicted standard deviation of gravity.
  RigOptions options;
  options.sigma_acc = 0;
  std::mt19937_64 random(7);
  const RigTruth truth = testing::simulateTruth(options, random);
  const Dataset data = testing::simulateMeasurements(truth, options, random);
  const auto pairs = tiltPairs(*data.imu, truth.left2world);
  const ImuStart at{truth.left2imu, truth.acc_bias, truth.gravity, 0};
  Fixed fixed;
  fixed.acc_bias = truth.acc_bias;
  // With rotation and bias known to first order, gravity is the mean of the readings along up.
  EXPECT_NEAR(imuPrecision(pairs, at, fixed, 0.05).gravity, 0.05 / std::sqrt(double(pairs.size())), 1e-9);
  EXPECT_TRUE(isDetermined(imuPrecision(pairs, at, {}, 0.05)));
  EXPECT_GT(imuPrecision(pairs, at, {}, 0.05).gravity, imuPrecision(pairs, at, fixed, 0.05).gravity);
}

std::string refusal(std::vector<TiltPair> pairs, const Fixed& fixed = {}) {
  ImuData imu{"imu.csv", {}};
  for (std::size_t i = 0; i < pairs.size(); ++i) imu.readings.push_back({int(i), pairs[i].acc, int(i) + 2});
  try {
    requireImuDetermined(imu, pairs, startImu(pairs, fixed, 0.05), fixed, 0.05);
  } catch (const DataError& error) {
    EXPECT_EQ(error.id(), "slom.calibration.imu-open");
    return std::string(error.sentence());
  }
  return "";
}

std::vector<TiltPair> cone(double tilt, int count) {
  std::vector<TiltPair> pairs;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * M_PI * i / count;
    const vec3 up = SO3::exp(vec3(tilt * std::cos(a), tilt * std::sin(a), 0.)) * vec3(0., 0., 1.);
    pairs.push_back({up, vec3(9.81 * up)});
  }
  return pairs;
}

/// Tilts about one axis, `step` apart.
std::vector<TiltPair> arc(double step, int count) {
  std::vector<TiltPair> pairs;
  for (int i = 0; i < count; ++i) {
    const vec3 up = SO3::exp(vec3(step * i, 0., 0.)) * vec3(0., 0., 1.);
    pairs.push_back({up, vec3(9.81 * up)});
  }
  return pairs;
}

TEST(ImuStart, RefusesWhatIsNotDeterminedAndSaysWhatHelps) {
  EXPECT_EQ(refusal(cone(0.5, 6)), "");
  EXPECT_EQ(
      refusal(arc(0.02, 6)),
      "imu.csv:2: 6 valid readings of tilts that spread by 2 deg do not determine the orientation of the "
      "IMU, acc_bias, gravity; add readings at other tilts, about more than one axis, or fix "
      "acc_bias");
  EXPECT_EQ(
      refusal(cone(0, 1)),
      "imu.csv:2: 1 valid reading of tilts that spread by 0 deg do not determine the orientation of the "
      "IMU, acc_bias, gravity; add readings at other tilts, about more than one axis");
  Fixed bias;
  bias.acc_bias = vec3();
  EXPECT_EQ(refusal(cone(0, 4), bias),
            "imu.csv:2: 4 valid readings of tilts that spread by 0 deg do not determine the orientation of "
            "the IMU, gravity; add readings at other tilts, about more than one axis");
}

}  // namespace
}  // namespace slom::calibration
