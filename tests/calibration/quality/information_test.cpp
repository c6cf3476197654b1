// The sum of the images' information is that of the fit of the rig: same standard deviations. The fit computes them
// from its own factor.
#include "calibration/quality/uncertainty/information.hpp"

#include <gtest/gtest.h>

#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/uncertainty/correlations.hpp"

namespace slom::calibration {
namespace {

void expectSameStandardDeviations(const testing::CalibratedRig& r) {
  ASSERT_TRUE(r.result.success()) << r.result.message << r.result.undetermined;
  const FittedRig rig(r.result);
  const Eigen::VectorXd std = testing::informationOfAll(r.data, rig).covariance().diagonal().cwiseSqrt();
  const auto expectNear = [&](int column, double expected) {
    EXPECT_NEAR(std[column], expected, 1e-5 * expected) << rig.columns.names[std::size_t(column)];
  };
  for (std::size_t c = 0; c < r.result.cameras.size(); ++c) {
    const CameraResult& camera = r.result.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i)
      expectNear(rig.columns.lens[c] + int(i), camera.parameters[i].std);
    for (int i = 0; i < 3 && c > 0; ++i) {
      expectNear(rig.columns.pose[c] + i, camera.translation_std[i]);
      expectNear(rig.columns.pose[c] + 3 + i, camera.rotation_std[i]);
    }
  }
  if (!r.result.imu) return;
  for (int i = 0; i < 3; ++i) {
    expectNear(rig.columns.imu + i, r.result.imu->rotation_std[i]);
    expectNear(rig.columns.imu + 3 + i, r.result.imu->acc_bias_std[i]);
  }
  expectNear(rig.columns.imu + 6, r.result.imu->gravity_std);
}

TEST(Information, IsThatOfTheJointFit) {
  testing::RigOptions options;
  options.cameras = 3;
  expectSameStandardDeviations(testing::calibratedRig(options, {}, 1, true));
}

TEST(Information, OfFixedAndBoundedParametersIsNone) {
  Settings settings;
  settings.lens.push_back({"", "k3", 0, 0});
  settings.lens.push_back({"a", "fx", 300, 500});  // the truth is 600: it ends at 500
  settings.fixed.gravity = 9.81;
  const auto rig = testing::calibratedRig(testing::RigOptions(), settings, 2, true);
  EXPECT_EQ(rig.result.active_bounds.size(), 1u);
  expectSameStandardDeviations(rig);
}

TEST(Information, OfASmallProblem) {
  expectSameStandardDeviations(testing::calibratedRig(testing::smallBoards(), testing::opencv4(), 3));
}

TEST(Correlations, AreThoseOfTheCovariance) {
  SharedColumns columns;
  columns.size = 4;
  columns.free = {0, 2, 3};
  columns.names = {"a", "b", "c", "d"};
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance.diagonal() << 4, 0, 9, 1;
  covariance(0, 2) = covariance(2, 0) = -5.7;
  covariance(2, 3) = covariance(3, 2) = 1.5;
  const Correlations correlations = correlationsOf(columns, covariance);
  EXPECT_EQ(correlations.names, (std::vector<std::string>{"a", "c", "d"}));
  EXPECT_DOUBLE_EQ(correlations.coefficient(2, 1), 0.5);
  ASSERT_EQ(correlations.strong.size(), 1u);
  EXPECT_EQ(correlations.strong[0].a, "a");
  EXPECT_EQ(correlations.strong[0].b, "c");
  EXPECT_DOUBLE_EQ(correlations.strong[0].coefficient, -0.95);
}

}  // namespace
}  // namespace slom::calibration
