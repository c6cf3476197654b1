// Types that can be marked as the datum.
#include <type_traits>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

const auto same = [](const auto& x) { return x; };

TEST(Measured, TakesIntegersAsNumbers) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  est.insertMeasurement(same, x, slom::measured(2));
  est.insertMeasurement(same, x, slom::measured(4L));
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_DOUBLE_EQ(*x, 3);
  static_assert(std::is_same_v<decltype(slom::measured(2)), slom::Measured<double>>);
  static_assert(std::is_same_v<decltype(slom::measured(2.0)), slom::Measured<double>>);
}

TEST(Measured, TakesExpressionsByTheirValue) {
  slom::Estimator est;
  const auto x = est.insertRV(Eigen::Vector3d(0, 0, 0), "x");
  const auto y = est.insertRV(mtk::vect<2>(0, 0), "y");
  const auto marked = [] {
    const Eigen::Vector3d temporary(1, 2, 3);
    return slom::measured(2 * temporary + Eigen::Vector3d::Ones());
  }();
  static_assert(std::is_same_v<decltype(marked), const slom::Measured<Eigen::Vector3d>>);
  est.insertMeasurement(same, x, marked);
  const mtk::vect<3> all(7, 8, 9);
  est.insertMeasurement(same, y, slom::measured(all.head<2>()));
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_TRUE(x->isApprox(Eigen::Vector3d(3, 5, 7)));
  EXPECT_TRUE(y->isApprox(Eigen::Vector2d(7, 8)));
  static_assert(std::is_same_v<decltype(slom::measured(all)), slom::Measured<mtk::vect<3>>>);
}

TEST(Measured, KeepsOwnTypes) {
  struct Camera : mtk::vect<2> {
    using mtk::vect<2>::vect;
  };
  static_assert(std::is_same_v<decltype(slom::measured(Camera(1, 2))), slom::Measured<Camera>>);
}

}  // namespace
