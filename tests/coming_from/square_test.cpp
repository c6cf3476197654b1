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
  // The last side is 10 cm too long: the opposite one takes a quarter of that, as all are equally accurate and what they turn hardly counts.
  EXPECT_NEAR(x[1]->pos.x(), 2, 0.03);
  EXPECT_NEAR(x[2]->pos.y(), 2, 0.06);
  EXPECT_LT(covariance(0, 0), 0.05 * 0.05 * 2);
  EXPECT_GT(covariance(0, 0), 0.05 * 0.05 / 2);
}

}  // namespace
