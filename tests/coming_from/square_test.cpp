// The map of docs/coming_from/gtsam.md and g2o.md by SLoM.
#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace {

TEST(ComingFromGtsam, ASquareCloses) {
  // clang-format off
  using Pose = mtk::trafo<mtk::SO2<>>;
  const double quarter = 3.14159265358979 / 2;
  const Pose side(mtk::SO2<>(quarter), mtk::vect<2>(2, 0));     // 2 m ahead, then a quarter turn to the left
  const slom::StandardDeviation noise(mtk::vect<3>(0.05, 0.05, 0.02));  // x, y [m], rotation [rad]

  slom::Estimator est;
  std::vector<slom::VarID<Pose>> x;
  x.push_back(est.insertRV(Pose(), false, "x0"));               // stays where it is
  for (int i = 1; i < 4; ++i) {
    x.push_back(est.insertRV(Pose(*x[i - 1] * side), "x" + std::to_string(i)));
    est.insertMeasurement(slom::RelativePose(), x[i - 1], x[i], slom::measured(side), noise);
  }
  est.insertMeasurement(slom::RelativePose(), x[3], x[0], slom::measured(Pose(mtk::SO2<>(quarter), mtk::vect<2>(2.1, 0))), noise);
  const slom::Summary summary = est.optimize();
  const Eigen::Matrix3d covariance = est.covariance(x[2]);
  // clang-format on
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_EQ(summary.redundancy, 3);
  // The last side is 10 cm too long. The opposite one takes a quarter of that, because all sides are equally accurate and
  // their rotations hardly count.
  EXPECT_NEAR(x[1]->pos.x(), 2, 0.03);
  EXPECT_NEAR(x[2]->pos.y(), 2, 0.06);
  EXPECT_LT(covariance(0, 0), 0.05 * 0.05 * 2);
  EXPECT_GT(covariance(0, 0), 0.05 * 0.05 / 2);
}

/// A prior along the axes of the body, as GTSAM's, and the same one along those of the world.
TEST(ComingFromGtsam, APriorAlongTheAxesOfTheBody) {
  for (const bool is_in_body : {true, false}) {
    slom::Estimator est;
    const auto robot = est.insertRV(mtk::trafo<mtk::SO3<>>(), "robot");
    const auto insert = [&] {
      // clang-format off
  using Pose = mtk::trafo<mtk::SO3<>>;
  const Pose start(mtk::SO3<>::exp(mtk::vect<3>(0, 0, 1.5707963267949)), mtk::vect<3>(1, 2, 0));
  mtk::vect<6> sigmas;
  sigmas << 0.5, 0.1, 0.1, 0.01, 0.01, 0.02;  // x, y, z of the body [m], then roll, pitch, yaw [rad]
  est.insertMeasurement(slom::RelativePose(), Pose(), robot, slom::measured(start), slom::StandardDeviation(sigmas));
      // clang-format on
    };
    const auto insert_in_world = [&](const mtk::trafo<mtk::SO3<>>& start) {
      // clang-format off
  mtk::vect<6> in_world;
  in_world << 0.1, 0.5, 0.1, 0.01, 0.01, 0.02;  // x, y, z of the world [m], then roll, pitch, yaw [rad]
  est.prior(robot, start, slom::StandardDeviation(in_world));
      // clang-format on
    };
    if (is_in_body) {
      insert();
    } else {
      insert_in_world({mtk::SO3<>::exp(mtk::vect<3>(0, 0, 1.5707963267949)), mtk::vect<3>(1, 2, 0)});
    }
    EXPECT_TRUE(est.optimize().converged);
    EXPECT_NEAR(robot->pos.y(), 2, 1e-9);
    mtk::vect<6> expected;
    expected << 0.1, 0.5, 0.1, 0.01, 0.01, 0.02;
    EXPECT_LT((est.standardDeviation(robot) - expected).norm(), 1e-9)
        << est.standardDeviation(robot).transpose();
    EXPECT_NEAR(est.covariance(robot)(0, 1), 0, 1e-12);
  }
}

}  // namespace
