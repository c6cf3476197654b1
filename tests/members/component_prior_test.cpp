// Priors on parts of variables, by their paths.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using SE3 = mtk::trafo<mtk::SO3<>>;
using vec3 = mtk::vect<3>;

/// A number above 0 whose [+] multiplies.
struct Gain {
  using scalar = double;
  static constexpr int DOF = 1;
  double value = 1;
  operator double() const { return value; }
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) { value *= std::exp(scale * d[0]); }
  void boxminus(mtk::vectview<double, 1> out, const Gain& y) const { out[0] = std::log(value / y.value); }
};

struct Head {
  SE3 pose;
  double gravity = 9.8;
  Gain gain;
};

/// A pose that sees landmarks.
struct LevelCamera {
  slom::Estimator est;
  slom::VarID<SE3> pose = est.insertRV(SE3(mtk::SO3<>::exp(vec3(0.1, 0.2, 0.3)), vec3(1, 2, 3)), "pose");
  LevelCamera() {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal;
    const SE3 truth(mtk::SO3<>::exp(vec3(0.2, 0.1, 0.4)), vec3(1.1, 1.9, 3.2));
    for (int i = 0; i < 4; ++i) {
      const vec3 p(normal(engine), normal(engine), normal(engine));
      const vec3 z = truth.inverse() * p + 0.01 * vec3(normal(engine), normal(engine), normal(engine));
      est.insertMeasurement([](const auto& T, const vec3& q) { return T.inverse() * q; }, pose, p,
                            slom::measured(z), slom::StandardDeviation(0.01));
    }
  }
};

void expectSame(LevelCamera& by_path, LevelCamera& by_function) {
  EXPECT_TRUE(by_path.est.optimize().converged);
  EXPECT_TRUE(by_function.est.optimize().converged);
  EXPECT_LT(mtk::difference(*by_path.pose, *by_function.pose).norm(), 1e-9);
  EXPECT_NEAR(by_path.est.getRSS(), by_function.est.getRSS(), 1e-8 * by_function.est.getRSS());
  EXPECT_TRUE(
      by_path.est.covariance(by_path.pose).isApprox(by_function.est.covariance(by_function.pose), 1e-6));
  EXPECT_TRUE(slom::checkDerivatives(by_path.est).ok()) << slom::checkDerivatives(by_path.est);
}

TEST(ComponentPrior, OfOneCoordinateIsTheFunctionThatReturnsIt) {
  LevelCamera by_path, by_function;
  slom::Estimator& est = by_path.est;
  const auto pose = by_path.pose;
  est.prior(pose, "pos.z", 3.3, 0.005);
  by_function.est.insertMeasurement([](const auto& T) { return T.pos[2]; }, by_function.pose,
                                    slom::measured(3.3), slom::StandardDeviation(0.005));
  expectSame(by_path, by_function);
}

TEST(ComponentPrior, OfAPathTakesAValueForEachCoordinateAndAnyNoise) {
  LevelCamera by_path, by_function;
  Eigen::Matrix3d C;
  C << 2, 1, 0, 1, 3, 0.5, 0, 0.5, 1;
  C *= 1e-5;
  const vec3 z(1, 2, 3.3);
  const auto id = by_path.est.prior(by_path.pose, "pos", z, slom::Covariance(C));
  by_function.est.insertMeasurement([](const auto& T) { return T.pos; }, by_function.pose, slom::measured(z),
                                    slom::Covariance(C));
  expectSame(by_path, by_function);
  EXPECT_TRUE(by_path.est.residual(id).isApprox(by_path.pose->pos - z, 1e-15));
  by_path.est.removeMeasurement(id);
  EXPECT_EQ(by_path.est.getM(), 12);
}

TEST(ComponentPrior, IsExactFarAway) {
  slom::Estimator est;
  const auto x = est.insertRV(vec3(1e12, 1, 1), "x");
  est.prior(x, "x", 1e-12, 1e-14);
  est.prior(x, "y", 1, 1);
  est.prior(x, "z", 1, 1);
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_EQ(x->x(), 1e-12);
}

TEST(ComponentPrior, OfNumbersInCompoundsAndOfDynamicVectors) {
#ifdef __clang__
  GTEST_SKIP() << "clang numbers the members of plain structs";
#endif
  slom::Estimator est;
  const auto head = est.insertRV(Head{}, "head");
  est.fix(&Head::pose, head);
  est.fix(&Head::gain, head);
  est.prior(head, "gravity", 9.81, 0.01);
  const auto vector = est.insertRV(Eigen::VectorXd(Eigen::VectorXd::Zero(5)), "vector");
  for (int i = 0; i < 5; ++i) est.prior(vector, std::to_string(i), i, 0.5);
  const auto number = est.insertRV(1.0, "number");
  est.prior(number, "", 7, 1);
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(head->gravity, 9.81, 1e-12);
  EXPECT_TRUE(vector->isApprox(Eigen::VectorXd::LinSpaced(5, 0, 4)));
  EXPECT_EQ(*number, 7);
  EXPECT_NEAR(est.standardDeviation(vector)[3], 0.5, 1e-12);
}

TEST(ComponentPrior, FaultsAreNamed) {
#ifdef __clang__
  GTEST_SKIP() << "clang numbers the members of plain structs";
#endif
  slom::Estimator est;
  const auto head = est.insertRV(Head{}, "head");
  EXPECT_EQ(
      messageOf([&] { est.prior(head, "pose.pos.w", 1, 1); }),
      "[slom.no-component] variable head has no component \"pose.pos.w\"; pass one of pose.pos.x, pose.pos.y, "
      "pose.pos.z, pose.orient.x, pose.orient.y, pose.orient.z, gravity, gain.0");
  EXPECT_EQ(
      messageOf([&] { est.prior(head, "pose.orient.x", 0.1, 1); }),
      "[slom.no-component] head.pose.orient.x is part of a rotation or the like, not a coordinate that [+] "
      "adds to; pass prior a value of the whole variable, or pass insertMeasurement a function that returns "
      "the part");
  EXPECT_EQ(
      messageOf([&] { est.prior(head, "gain", 2, 1); }),
      "[slom.no-component] head.gain.0 is part of a rotation or the like, not a coordinate that [+] adds to; "
      "pass prior a value of the whole variable, or pass insertMeasurement a function that returns the part");
  EXPECT_EQ(
      messageOf([&] { est.prior(head, "pose.pos", 2, 1); }),
      "[slom.wrong-length] the prior on \"pose.pos\" of variable head has 1 value, the path names 3 components; pass "
      "one value for each");
  EXPECT_EQ(messageOf([&] { est.prior(head, "pose.pos", vec3(1, NAN, 1), 1); }),
            "[slom.prior-not-finite] the value of the prior on head.pose.pos.y is nan; pass a finite number");
  EXPECT_EQ(
      messageOf([&] { est.prior(head, "gravity", 1, -1); }),
      "[slom.not-positive-definite] standard deviation of measurement prior #1 is -1; pass positive finite numbers");
  EXPECT_EQ(est.getM(), 0);
}

}  // namespace
