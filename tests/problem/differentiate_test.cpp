// Central differences against exact derivatives, over scales from 1e-20 to 1e7, at zero and on manifolds.
#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The Jacobian as the estimator computes it.
struct DenseProblem {
  slom::Estimator est;
  slom::DenseQR* solver = new slom::DenseQR;
  DenseProblem() { est.changeSolver(std::unique_ptr<slom::LinearSolver>(solver)); }
  MatrixXd jacobian() {
    slom::Options options;
    options.max_iterations = 0;
    est.optimize(options);
    return solver->jacobian();
  }
};

double relativeError(const MatrixXd& got, const MatrixXd& want) { return (got - want).norm() / want.norm(); }

/// f(x) = A exp(x / s): bends over lengths of order s.
double errorOfExponential(double x, double s, double amplitude = 1) {
  DenseProblem p;
  const auto id = p.est.insertRV(x);
  p.est.insertMeasurement([=](const double& v) { return amplitude * std::exp(v / s); }, id);
  return relativeError(p.jacobian(), MatrixXd::Constant(1, 1, amplitude / s * std::exp(x / s)));
}

TEST(CentralDifferences, FitTheScaleOfTheComponent) {
  for (const double s : {1e-20, 1e-12, 1e-7, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6}) {
    for (const double share : {-2.0, -1.0, 0.5, 1.0, 3.0}) {
      EXPECT_LT(errorOfExponential(share * s, s), 1e-7) << "x = " << share * s << ", scale " << s;
      EXPECT_LT(errorOfExponential(share * s, s, 1e9), 1e-7) << "x = " << share * s << ", scale " << s;
    }
  }
}

TEST(CentralDifferences, WorkAtAndNearZero) {
  for (const double s : {1e-3, 0.1, 1.0, 100.0}) {
    for (const double x : {0.0, 1e-300, 1e-17, -1e-12, 1e-9, 1e-5}) {
      EXPECT_LT(errorOfExponential(x, s), 1e-7) << "x = " << x << ", scale " << s;
    }
  }
}

TEST(CentralDifferences, WorkFarFromTheOrigin) {
  // Coordinates of a surveyor: millions of metres, distances of ten.
  DenseProblem p;
  const Eigen::Vector2d at(4.5e6, 5.4e6), to = at + Eigen::Vector2d(6, 8);
  const auto id = p.est.insertRV(at);
  p.est.insertMeasurement([=](const Eigen::Vector2d& v) { return (v - to).norm(); }, id);
  EXPECT_LT(relativeError(p.jacobian(), Eigen::RowVector2d(-0.6, -0.8)), 3e-6);
}

/// A sine of a large argument still bends over lengths of 1. Differences of plain steps are as exact as the argument.
TEST(CentralDifferences, FollowPeriodicFunctionsOfLargeArguments) {
  for (const double x : {3.0, 100.0, 1e4, 1e6 + 0.3, 1e8 + 0.7}) {
    for (const bool extrapolate : {false, true}) {
      DenseProblem p;
      const auto id = p.est.insertRV(x);
      const auto wave = [](const double& v) { return std::sin(v); };
      if (extrapolate) {
        p.est.insertMeasurement(slom::numeric(wave, slom::Richardson()), id);
      } else {
        p.est.insertMeasurement(slom::numeric(wave), id);
      }
      EXPECT_LT(relativeError(p.jacobian(), MatrixXd::Constant(1, 1, std::cos(x))),
                3e-6 * std::max(1.0, x / 1e6))
          << x << ", " << extrapolate;
    }
  }
}

TEST(CentralDifferences, StayInsideTheDomainWhereTheyCan) {
  DenseProblem p;
  const auto id = p.est.insertRV(1e-7);
  p.est.insertMeasurement([](const double& v) { return std::log(v); }, id);
  EXPECT_LT(relativeError(p.jacobian(), MatrixXd::Constant(1, 1, 1e7)), 1e-7);
}

TEST(CentralDifferences, OfLinearFunctionsAreExact) {
  DenseProblem p;
  MatrixXd A(5, 3);
  A << 1, 2, 3, -4, 5, 6, 7, -8, 9, 1e-6, 1e6, 0, 0, 0, 1;
  const auto id = p.est.insertRV(mtk::vect<3>(0.3, -200, 0));
  p.est.insertMeasurement([=](const mtk::vect<3>& v) -> VectorXd { return A * v; }, id);
  const MatrixXd J = p.jacobian();
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(J(i, j), A(i, j), 1e-8 * A.row(i).norm()) << i << " " << j;
  }
}

TEST(CentralDifferences, LiveInTheTangentSpace) {
  // d/dd of (T exp(d)) p is [I, -R [p]x] for our perturbations.
  using SE3 = mtk::trafo<mtk::SO3<>>;
  DenseProblem p;
  const SE3 T(mtk::SO3<>::exp(mtk::vect<3>(3.1, 0.3, -0.2)), mtk::vect<3>(1, 0, -20));
  const mtk::vect<3> point(0.4, -0.7, 2);
  const auto id = p.est.insertRV(T);
  const auto fixed = p.est.insertRV(mtk::vect<3>(), false);
  p.est.insertMeasurement(
      [](const SE3& pose, const mtk::vect<3>& z, const mtk::vect<3>& x) { return pose * x - z; }, id, fixed,
      point, slom::StandardDeviation(0.5));
  Eigen::Matrix<double, 3, 6> expected;
  Eigen::Matrix3d cross;
  cross << 0, -point[2], point[1], point[2], 0, -point[0], -point[1], point[0], 0;
  expected << Eigen::Matrix3d::Identity(), -T.orient.toRotationMatrix() * cross;
  const MatrixXd J = p.jacobian();
  ASSERT_EQ(J.cols(), 6);
  EXPECT_LT(relativeError(J, 2 * expected), 1e-9);
}

TEST(CentralDifferences, EvaluateOnlyWhatDependsOnAVariable) {
  slom::Estimator est;
  est.setThreads(1);
  int calls = 0;
  std::vector<slom::VarID<mtk::vect<2>>> ids;
  for (int i = 0; i < 10; ++i) {
    ids.push_back(est.insertRV(mtk::vect<2>(1, 2)));
    est.insertMeasurement([&calls](const mtk::vect<2>& v) { return ++calls, v; }, ids.back());
  }
  est.optimizeStep();
  // Each: once in the middle, two for each of two components, once at the new values.
  EXPECT_EQ(calls, 10 * (1 + 4 + 1));
}

}  // namespace
