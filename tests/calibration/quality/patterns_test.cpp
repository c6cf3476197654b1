// Patterns of residuals. Patterns planted in simulated images are found with their size. In images without patterns,
// none are found. Seeds are fixed.
#include "calibration/quality/patterns/patterns.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/patterns/flip_test.hpp"
#include "support/message_of.hpp"

namespace slom::calibration {
namespace {

using testing::CalibratedRig;
using Kind = ResidualPattern::Kind;

testing::RigOptions recording(int cameras, int images) {
  testing::RigOptions options = testing::smallBoards();
  options.cameras = cameras;
  options.images = images;
  return options;
}

/// Changes the pixel of a corner: of view i of a camera, corner k.
using Plant = std::function<void(std::size_t camera, std::size_t i, std::size_t k, Corner& corner)>;

struct Fitted {
  Dataset data;
  Result result;
  std::vector<ResidualPattern> patterns;

  const ResidualPattern* find(Kind kind, std::size_t camera = 0) const {
    for (const ResidualPattern& pattern : patterns) {
      if (pattern.kind == kind && pattern.camera == camera) return &pattern;
    }
    return nullptr;
  }
};

Fitted fitted(Dataset data) {
  Fitted fitted{std::move(data), {}, {}};
  Settings settings;
  settings.robust = Robust::none;
  fitted.result = calibrate(fitted.data, settings);
  EXPECT_TRUE(fitted.result.success());
  const FittedRig rig(fitted.result);
  const Eigen::MatrixXd covariance = testing::informationOfAll(fitted.data, rig).covariance();
  fitted.patterns =
      residualPatterns(fitted.data, rig, covariance, testing::grids(fitted.data, 33, 25), settings.limits);
  return fitted;
}

Fitted withPlanted(const CalibratedRig& rig, const Plant& plant) {
  Dataset data = rig.data;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (std::size_t i = 0; i < data.cameras[c].views.size(); ++i) {
      auto& corners = data.cameras[c].views[i].corners;
      for (std::size_t k = 0; k < corners.size(); ++k) plant(c, i, k, corners[k]);
    }
  }
  return fitted(std::move(data));
}

/// Motion of a corner of the simulation from one image to the next, as both neighbours show it; 0 at the ends.
Eigen::Vector2d motionOf(const Dataset& data, std::size_t camera, std::size_t i, int number) {
  const auto& views = data.cameras[camera].views;
  const auto pixel = [&](const View& view) {
    const auto at = std::find_if(view.corners.begin(), view.corners.end(),
                                 [&](const Corner& c) { return c.number == number; });
    return at == view.corners.end() ? Eigen::Vector2d(Eigen::Vector2d::Constant(NAN))
                                    : Eigen::Vector2d(at->pixel);
  };
  if (i == 0 || i + 1 == views.size()) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d motion =
      (pixel(views[i + 1]) - pixel(views[i - 1])) / (views[i + 1].image - views[i - 1].image);
  return motion.allFinite() ? motion : Eigen::Vector2d::Zero();
}

class Patterns : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    rig_ = new CalibratedRig(testing::calibratedRig(recording(2, 48), Settings(), 3));
  }
  static void TearDownTestSuite() { delete rig_; }
  static CalibratedRig* rig_;

  std::mt19937_64 random_{8};
  std::normal_distribution<> normal_;
};
CalibratedRig* Patterns::rig_ = nullptr;

TEST_F(Patterns, AreNotFoundInIndependentNoise) {
  int all = 0, below = 0;
  std::vector<std::string> found;
  double explained = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Fitted fit = fitted(testing::calibratedRig(recording(2, 20), Settings(), seed).data);
    for (const ResidualPattern& pattern : fit.patterns) {
      ++all;
      below += pattern.probability < 0.1;
      EXPECT_EQ(pattern.blocks, 12);
      if (std::isfinite(pattern.share)) explained += pattern.share;
      if (pattern.isFound()) found.push_back(toString(pattern.kind));
    }
  }
  EXPECT_EQ(all, 12 * (2 * 9 + 1));
  EXPECT_GT(below, 0.05 * all);
  EXPECT_LT(below, 0.16 * all);
  EXPECT_LE(found.size(), 2u) << ::testing::PrintToString(found);
  EXPECT_NEAR(explained / all, 0, 0.005);
}

TEST_F(Patterns, ABoardThatIsNotFlatIsMeasured) {
  std::vector<vec3> off(31);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (vec3& d : off) {
    for (const int k : {0, 1, 2}) d[k] = (k < 2 ? 2e-4 : 8e-4) * normal_(random_);
    squares += Eigen::Vector3d(d.cwiseAbs2()) / double(off.size());
  }
  const BoardPlane plane = fitPlane(rig_->data.cameras[0].views[0].corners);
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    const SE3& left2world = rig_->truth.left2world.at(rig_->data.cameras[c].views[i].image);
    const CameraResult& camera = rig_->result.cameras[c];
    const auto pixel = [&](const vec3& p) {
      return camera.project(camera.left2camera * (left2world.inverse() * p));
    };
    const vec3 moved(corner.world + plane.plane2world.orient * off[std::size_t(corner.number)]);
    corner.pixel += pixel(moved) - pixel(corner.world);
  });
  const ResidualPattern& board = *fit.find(Kind::board_shape);
  EXPECT_TRUE(board.isFound());
  // Poses and lens follow a part of it.
  EXPECT_GT(board.value, 0.65 * std::sqrt(squares.z()));
  EXPECT_LT(board.value, 1.05 * std::sqrt(squares.z()));
  const double within = std::sqrt((squares.x() + squares.y()) / 2);
  EXPECT_GT(board.second, 0.65 * within);
  EXPECT_LT(board.second, 1.15 * within);
  EXPECT_GT(board.share, 0.1);
  double product = 0, square = 0;
  for (const MovedCorner& corner : board.corners) {
    const vec3 planted(plane.plane2world.orient * off[std::size_t(corner.number)]);
    product += planted.dot(corner.displacement);
    square += planted.squaredNorm();
  }
  EXPECT_GT(product / square, 0.5);
  EXPECT_LT(product / square, 1.1);
}

TEST_F(Patterns, ALensThatTheModelDoesNotHaveIsSeenByPlace) {
  const Fitted fit = withPlanted(*rig_, [](std::size_t c, std::size_t, std::size_t, Corner& corner) {
    if (c == 1) corner.pixel += vec2(0.3 * std::sin(corner.pixel.x() / 40), 0.);
  });
  const ResidualPattern& place = *fit.find(Kind::image_place, 1);
  EXPECT_TRUE(place.isFound());
  // Of u alone, a sine, of which the means over cells of 80 px keep 0.84, and the lens follows a part.
  EXPECT_GT(place.value, 0.5 * 0.84 * 0.15);
  EXPECT_LT(place.value, 1.05 * 0.84 * 0.15);
  EXPECT_FALSE(fit.find(Kind::image_place, 0)->isFound());
}

TEST_F(Patterns, ALensThatChangesIsNamed) {
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    const double time = 2.0 * double(i) / double(rig_->data.cameras[0].views.size() - 1) - 1;
    if (c == 0)
      corner.pixel +=
          vec2(0., 0.004 * time * (corner.pixel.y() - rig_->result.cameras[0].camera_matrix(1, 2)));
  });
  const ResidualPattern& drift = *fit.find(Kind::drift);
  EXPECT_TRUE(drift.isFound());
  EXPECT_EQ(drift.parameter, "fy");
  const double fy = rig_->result.cameras[0].camera_matrix(1, 1);
  EXPECT_NEAR(drift.value, 0.008 * fy, 0.002 * fy);
}

TEST_F(Patterns, APrincipalPointThatPosesFollowHasItsSize) {
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    if (c == 0)
      corner.pixel += vec2(10 * (2.0 * double(i) / double(rig_->data.cameras[0].views.size() - 1) - 1), 0.);
  });
  const ResidualPattern& drift = *fit.find(Kind::drift);
  EXPECT_TRUE(drift.isFound());
  EXPECT_EQ(drift.parameter, "cx");
  EXPECT_NEAR(drift.value, 20, 4);
}

TEST_F(Patterns, RowsThatAreReadOneAfterTheOtherAreTimed) {
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    if (c == 1)
      corner.pixel += vec2(0.02 * corner.pixel.y() / 480 * motionOf(rig_->data, c, i, corner.number));
  });
  const ResidualPattern& readout = *fit.find(Kind::row_readout, 1);
  EXPECT_TRUE(readout.isFound());
  EXPECT_NEAR(readout.value, 0.02, 0.004);
}

TEST_F(Patterns, ACameraThatIsLateIsTimed) {
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    if (c == 1) corner.pixel += vec2(-0.01 * motionOf(rig_->data, c, i, corner.number));
  });
  const ResidualPattern& offset = *fit.find(Kind::time_offset, 1);
  EXPECT_TRUE(offset.isFound());
  EXPECT_NEAR(offset.value, -0.01, 0.002);
  EXPECT_EQ(fit.find(Kind::time_offset, 0), nullptr);
}

TEST_F(Patterns, BlurIsSeenAlongTheMotion) {
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    corner.pixel += vec2(0.01 * normal_(random_) * motionOf(rig_->data, c, i, corner.number));
  });
  for (const Kind kind : {Kind::motion_blur, Kind::speed}) {
    EXPECT_TRUE(fit.find(kind)->isFound()) << toString(kind);
    EXPECT_GT(fit.find(kind)->value, 1.5);
  }
}

TEST_F(Patterns, ErrorsThatNeighboursShareAreSeen) {
  std::vector<double> phase(100);
  for (double& x : phase) x = 2 * std::numbers::pi * normal_(random_);
  const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
    if (c == 0) corner.pixel += vec2(1.5 * std::sin(12 * corner.world.norm() + phase[i]), 0.);
  });
  const ResidualPattern& neighbours = *fit.find(Kind::neighbours);
  EXPECT_TRUE(neighbours.isFound());
  EXPECT_GT(neighbours.value, 0.2);
  EXPECT_LT(neighbours.value, 0.9);
}

TEST_F(Patterns, CornersThatAreFoundWorseOnSlantedOrFarBoardsAreSeen) {
  std::vector<double> slant, distance;
  for (const View& view : rig_->data.cameras[0].views) {
    const SE3& left2world = rig_->truth.left2world.at(view.image);
    const Eigen::Vector3d centre = left2world.inverse() * view.corners[view.corners.size() / 2].world;
    const Eigen::Vector3d normal = left2world.orient.toRotationMatrix().transpose() *
                                   fitPlane(view.corners).plane2world.orient.toRotationMatrix().col(2);
    slant.push_back(std::acos(std::abs(normal.dot(centre)) / centre.norm()));
    distance.push_back(centre.norm());
  }
  const auto above = [](std::vector<double> all, double x) {
    std::sort(all.begin(), all.end());
    return x > all[all.size() * 2 / 3];
  };
  for (const Kind kind : {Kind::slant, Kind::distance}) {
    const auto& facts = kind == Kind::slant ? slant : distance;
    const Fitted fit = withPlanted(*rig_, [&](std::size_t c, std::size_t i, std::size_t, Corner& corner) {
      if (c == 0 && above(facts, facts[i]))
        corner.pixel += vec2(0.5 * normal_(random_), 0.5 * normal_(random_));
    });
    EXPECT_TRUE(fit.find(kind)->isFound()) << toString(kind);
    EXPECT_GT(fit.find(kind)->value, 1.5);
  }
}

TEST(FlipTest, CountsSigns) {
  // Sums 1, 2 and 4: no other signs give as much as all alike.
  const Eigen::Vector3d sums(1, 2, 4);
  const FlipTest test(sums * sums.transpose());
  EXPECT_EQ(test.probability(), 0.25);
  EXPECT_EQ(test.explained(), 2 * (2 + 4 + 8));
  EXPECT_EQ(FlipTest(Eigen::MatrixXd::Zero(3, 3)).probability(), 1);
  EXPECT_EQ(probabilityOfSum(sums), 0.125);
  EXPECT_EQ(probabilityOfSum(-sums), 1);
  EXPECT_EQ(probabilityOfSum(Eigen::Vector3d(1, 2, -4)), 0.625);  // 7, 5, 3, 1 and -1 of 8
}

TEST(Patterns2, AreAskedOfNineImages) {
  EXPECT_TRUE(fitted(testing::calibratedRig(recording(1, 8), Settings(), 1).data).patterns.empty());
  EXPECT_FALSE(fitted(testing::calibratedRig(recording(1, 9), Settings(), 1).data).patterns.empty());
}

TEST(Patterns2, HaveSentences) {
  Result result;
  result.cameras.resize(2);
  result.cameras[0].name = "left";
  result.cameras[1].name = "right";
  const auto sentence = [&](Kind kind, double value, double share = NAN, double second = NAN) {
    return sentenceOf(
        {.kind = kind, .camera = 1, .value = value, .second = second, .parameter = "fx", .share = share},
        result);
  };
  EXPECT_EQ(
      sentence(Kind::board_shape, 0.00083, 0.123, 0.0002),
      "in all images of right, the same corners of the board are displaced from their stated positions, "
      "by at least 0.83 mm off the plane and 0.20 mm within it (RMS), which explains 12 % of the squared "
      "residuals; estimate the corners (--board-shape free), or lay the board on something flat and "
      "measure the print");
  EXPECT_EQ(
      sentence(Kind::drift, -1.234, 0.02),
      "the lens of right changes over the images: fx by -1.2 from the first to the last, which explains "
      "2.0 % of the squared residuals; check whether the focus moved, the camera warmed up, or the lens "
      "model is too simple for images that change over time");
  EXPECT_EQ(
      sentence(Kind::time_offset, -0.01, 0.3),
      "residuals of right follow the motion, as if it were 0.010 of the interval between image numbers "
      "earlier than left, which explains 30 % of the squared residuals; check the time stamps, hold the "
      "cameras still while they take images, or, with an --imu-stream, add --camera-offsets");
  EXPECT_EQ(
      sentence(Kind::slant, 1.61),
      "residuals of right are 1.6 times as large in the most slanted quarter of its images as in the most "
      "frontal one: corners are less exact there than the stated sigma");
  EXPECT_EQ(
      slom::testing::messageOf([&] { sentenceOf(ResidualPattern{.camera = 2}, result); }),
      "[slom.calibration.bad-question] there is no camera 2; pass one of the patterns of this result's quality");
}

}  // namespace
}  // namespace slom::calibration
