// The code of docs/run_time_variables.md about kinds that choose their variables at run time.
#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace {

using Vec2 = mtk::vect<2>;

TEST(Documentation, GaussianPrior) {
  slom::Estimator est;
  const auto pose = est.insertRV(mtk::trafo<mtk::SO2<>>(), "pose");
  const auto landmark = est.insertRV(Vec2(3, 4), "landmark");
  const auto scale = est.insertRV(1.0, "scale");
  const Eigen::MatrixXd R = 10 * Eigen::MatrixXd::Identity(6, 6);
  // clang-format off
  const auto prior = est.insertMeasurement(slom::GaussianPrior({pose, landmark, scale}, R));
  est.insertMeasurement(slom::GaussianPrior({scale}, Eigen::MatrixXd::Constant(1, 1, 5)).linearizedAt(scale, 1.2),
                        slom::Huber(2), slom::named("scale"));
  // clang-format on
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*scale, (100 * 1 + 25 * 1.2) / 125, 1e-12);
  est.removeMeasurement(prior);
}

TEST(Documentation, ListOfVariables) {
  slom::Estimator est;
  const auto a = est.insertRV(Vec2(1, 0), "a"), b = est.insertRV(Vec2(0, 1), "b");
  const auto scale = est.insertRV(2.0, "scale");
  for (const auto& id : {a, b}) est.prior(id, *id, 1.0);
  // clang-format off
  std::vector<slom::AnyVarID> variables{scale, a, b};  // any types, any number

  est.insertMeasurement(
      [](std::span<const slom::VariableView> x, double length) {
        Eigen::VectorXd r(x.size() - 1);
        for (std::size_t i = 1; i < x.size(); ++i)
          r[static_cast<Eigen::Index>(i) - 1] = x[0].as<double>() * x[i].as<mtk::vect<2>>().norm() - length;
        return r;
      },
      variables, 3.0, slom::StandardDeviation(0.1), slom::named("lengths"));
  // clang-format on
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*scale, 3, 1e-6);
}

}  // namespace
