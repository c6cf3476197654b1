// The uncertainty of a pixel equals that of the formula over all columns, and that of the grid. Invalid requests are
// named.
#include "slom/calibration/pixel_uncertainty.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/quality/calibrated_rig.hpp"
#include "support/message_of.hpp"

namespace slom::calibration {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

testing::CalibratedRig rigOf(unsigned seed) {
  return testing::calibratedRig(testing::smallBoards(), testing::opencv4(), seed);
}

TEST(PixelUncertainty, IsThatOfAllColumns) {
  const testing::CalibratedRig r = rigOf(3);
  const FittedRig rig(r.result);
  const Posterior posterior(testing::informationOfAll(r.data, rig));
  const PixelUncertainty uncertainty(r.data, r.result);
  for (std::size_t c = 0; c < 2; ++c) {
    for (const vec2& pixel : {vec2(320., 240.), vec2(0., 0.), vec2(639., 100.), vec2(17.5, 460.25)}) {
      const vec3 ray = *r.result.cameras[c].ray(pixel);
      for (const double distance : {0.1, 0.7, 30., kInfinity}) {
        const Eigen::Matrix2d expected = projectedPoint(rig, c, ray, distance).covariance(posterior);
        const std::optional<PixelCovariance> known = uncertainty.at(c, pixel, distance);
        ASSERT_TRUE(known);
        EXPECT_LT((known->matrix() - expected).norm(), 1e-9 * expected.norm()) << pixel << " " << distance;
        EXPECT_NEAR(known->largestStd() * known->largestStd(),
                    expected.selfadjointView<Eigen::Lower>().eigenvalues()[1], 1e-9 * expected.norm());
      }
    }
  }
}

TEST(PixelUncertainty, IsThatOfTheGrid) {
  const testing::CalibratedRig r = rigOf(4);
  const Quality quality = assess(r.data, r.settings, r.result);
  const PixelUncertainty uncertainty(r.data, r.result);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraQuality& camera = quality.cameras[c];
    for (const ProjectionUncertainty& map : camera.projection) {
      for (int i = 0; i < camera.grid.size(); i += 7) {
        const auto known = uncertainty.at(c, camera.grid.node(i), map.distance_m);
        if (!known) continue;  // the grid finds rays from its neighbours
        EXPECT_NEAR(known->largestStd(), map.std_px[std::size_t(i)], 1e-6 * map.std_px[std::size_t(i)]);
      }
    }
  }
}

TEST(PixelUncertainty, SaysWhatCannotBeAsked) {
  testing::CalibratedRig r = rigOf(5);
  const PixelUncertainty uncertainty(r.data, r.result);
  const vec2 middle(320., 240.);
  EXPECT_EQ(slom::testing::messageOf([&] { uncertainty.at(2, middle); }),
            "[slom.calibration.bad-question] there is no camera 2; pass a number from 0 to 1");
  EXPECT_EQ(slom::testing::messageOf([&] { uncertainty.at(0, vec2(std::nan(""), 1.)); }),
            "[slom.calibration.bad-question] the pixel is (nan, 1); pass finite numbers");
  EXPECT_EQ(slom::testing::messageOf([&] { uncertainty.at(0, middle, -1); }),
            "[slom.calibration.bad-question] the distance is -1 m; pass a positive number, or infinity");
  EXPECT_EQ(slom::testing::messageOf([&] { uncertainty.at(0, middle, 0); }),
            "[slom.calibration.bad-question] the distance is 0 m; pass a positive number, or infinity");
  EXPECT_EQ(slom::testing::messageOf([&] { uncertainty.at(0, middle, std::nan("")); }),
            "[slom.calibration.bad-question] the distance is nan m; pass a positive number, or infinity");

  const std::string remedy = "; pass the result of calibrate() with these data";
  const std::string refused = "[slom.calibration.no-result] there is no uncertainty of pixels: ";
  Dataset other = r.data;
  other.cameras[1].views.back().image = 1000;
  EXPECT_EQ(slom::testing::messageOf([&] { PixelUncertainty(other, r.result); }),
            refused + "image 1000 of " + other.cameras[1].name + " is not in the result" + remedy);
  other.cameras.pop_back();
  EXPECT_EQ(slom::testing::messageOf([&] { PixelUncertainty(other, r.result); }),
            refused + "the number of cameras is 1 in the data and 2 in the result" + remedy);
  Result open = r.result;
  open.undetermined = "left.k1 is open";
  EXPECT_EQ(slom::testing::messageOf([&] { PixelUncertainty(r.data, open); }),
            refused + "left.k1 is open" + remedy);
  open = r.result;
  open.converged = false;
  EXPECT_EQ(slom::testing::messageOf([&] { PixelUncertainty(r.data, open); }),
            refused + "the calibration did not converge" + remedy);
}

}  // namespace
}  // namespace slom::calibration
