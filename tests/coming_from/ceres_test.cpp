// The problems of docs/coming_from/ceres.md by Ceres and by SLoM. As the page says, values and covariances agree.
#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

// clang-format off
struct OnCircle {
  Eigen::Vector2d point;
  template <class T>
  bool operator()(const T* centre, const T* radius, T* residual) const {
    const T dx = point.x() - centre[0], dy = point.y() - centre[1];
    residual[0] = (sqrt(dx * dx + dy * dy) - radius[0]) / 0.1;
    return true;
  }
};
// clang-format on

// clang-format off
struct RotationDifference {
  Eigen::Quaterniond measured;
  template <class T>
  bool operator()(const T* q, T* residual) const {
    const Eigen::Quaternion<T> d = measured.conjugate().cast<T>() * Eigen::Map<const Eigen::Quaternion<T>>(q);
    const T wxyz[4] = {d.w(), d.x(), d.y(), d.z()};
    ceres::QuaternionToAngleAxis(wxyz, residual);
    for (int i = 0; i < 3; ++i) residual[i] /= 0.01;
    return true;
  }
};
// clang-format on

// clang-format off
struct Watch : ceres::IterationCallback {
  std::vector<double> costs;
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& s) override {
    costs.push_back(s.cost);
    return s.cumulative_time_in_seconds > 60 ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
};
// clang-format on

/// Twice the quaternion's x, measured as 0.
struct About {
  template <class T>
  bool operator()(const T* q, T* residual) const {
    residual[0] = T(2.0) * q[0] / T(0.002);
    return true;
  }
};

const std::vector<Eigen::Vector2d> points{{3.9, 1.0},  {3.1, 3.2},   {1.0, 4.1}, {-1.1, 3.0},
                                          {-2.0, 1.1}, {-1.2, -1.1}, {0.9, -2.0}};

TEST(ComingFromCeres, ACircleIsTheSame) {
  // clang-format off
  double centre[2] = {0, 0}, radius = 1;
  ceres::Problem problem;
  for (const auto& p : points) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OnCircle, 1, 2, 1>(new OnCircle{p}), nullptr, centre, &radius);
  }
  ceres::Solver::Options options;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  ceres::Covariance covariance{ceres::Covariance::Options()};
  covariance.Compute(std::vector<std::pair<const double*, const double*>>{{&radius, &radius}}, &problem);
  double variance;
  covariance.GetCovarianceBlock(&radius, &radius, &variance);
  // clang-format on

  slom::Estimator est;
  const auto c = est.insertRV(Eigen::Vector2d(0, 0), "centre");
  const auto r = est.insertRV(1.0, "radius");
  for (const auto& p : points) {
    // clang-format off
    est.insertMeasurement([](const auto& c, const auto& r, const auto& point) { return (point - c).norm() - r; },
                          c, r, p, slom::StandardDeviation(0.1));
    // clang-format on
  }
  const slom::Summary fit = est.optimize();
  EXPECT_NEAR(*r, radius, 1e-4);  // where Ceres stops by default, with function_tolerance 1e-6
  EXPECT_NEAR(c->x(), centre[0], 1e-4);
  EXPECT_NEAR(fit.final_rss, 2 * summary.final_cost, 1e-6);
  EXPECT_NEAR(est.standardDeviation(r)[0], std::sqrt(variance), 1e-6);
}

TEST(ComingFromCeres, ALossIsInStandardDeviations) {
  std::vector<Eigen::Vector2d> with_outlier = points;
  with_outlier[2] = {1.0, 5.6};
  // clang-format off
  double centre[2] = {0, 0}, radius = 1;
  ceres::Problem problem;
  for (const auto& p : with_outlier) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OnCircle, 1, 2, 1>(new OnCircle{p}), new ceres::HuberLoss(1.345),
                             centre, &radius);
  }
  // clang-format on
  ceres::Solver::Options options;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  slom::Estimator est;
  const auto c = est.insertRV(Eigen::Vector2d(0, 0), "centre");
  const auto r = est.insertRV(1.0, "radius");
  const auto on_circle = [](const auto& c, const auto& r, const auto& point) {
    return (point - c).norm() - r;
  };
  for (const auto& p : with_outlier) {
    // clang-format off
    est.insertMeasurement(on_circle, c, r, p, slom::StandardDeviation(0.1), slom::Huber(1.345));
    // clang-format on
  }
  const slom::Summary fit = est.optimize();
  EXPECT_TRUE(fit.converged) << fit;
  EXPECT_NEAR(*r, radius, 1e-6);
  EXPECT_NEAR(fit.final_rss, 2 * summary.final_cost, 1e-8);
}

TEST(ComingFromCeres, RotationsArePerturbedOnTheOtherSideByHalfTheVector) {
  const Eigen::Quaterniond first(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  const std::vector<Eigen::Quaterniond> measured{
      first, first * Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitX())),
      first * Eigen::Quaterniond(Eigen::AngleAxisd(0.015, Eigen::Vector3d::UnitZ()))};
  // clang-format off
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  ceres::Problem problem;
  problem.AddParameterBlock(q.coeffs().data(), 4, new ceres::EigenQuaternionManifold);
  for (const auto& z : measured) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<RotationDifference, 3, 4>(new RotationDifference{z}), nullptr,
                             q.coeffs().data());
  }
  // clang-format on
  // This one makes the covariance differ from a multiple of the identity.
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<About, 1, 4>(new About), nullptr,
                           q.coeffs().data());
  ceres::Solver::Options options;
  options.function_tolerance = options.parameter_tolerance = 1e-15;
  options.gradient_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ceres::Covariance covariance{ceres::Covariance::Options()};
  using Blocks = std::vector<std::pair<const double*, const double*>>;
  ASSERT_TRUE(covariance.Compute(Blocks{{q.coeffs().data(), q.coeffs().data()}}, &problem));
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> there;
  covariance.GetCovarianceBlockInTangentSpace(q.coeffs().data(), q.coeffs().data(), there.data());

  slom::Estimator est;
  // clang-format off
  auto R = est.insertRV(mtk::SO3<>(), "R");
  for (const auto& z : measured) {
    est.insertMeasurement([](const auto& R) { return R; }, R, slom::measured(mtk::SO3<>(z)), slom::StandardDeviation(0.01));
  }
  // clang-format on
  est.insertMeasurement([](const auto& R) { return 2.0 * R.x(); }, R, slom::StandardDeviation(0.002));
  const slom::Summary fit = est.optimize();
  EXPECT_TRUE(fit.converged) << fit;
  EXPECT_NEAR(fit.final_rss, 2 * summary.final_cost, 1e-6 * fit.final_rss);
  EXPECT_LT(q.angularDistance(R->quaternion()), 1e-7);
  // clang-format off
  const Eigen::Matrix3d turn = q.toRotationMatrix();
  const Eigen::Matrix3d here = 4 * turn.transpose() * there * turn;
  // clang-format on
  EXPECT_LT((est.covariance(R) - here).norm(), 1e-5 * here.norm()) << est.covariance(R) << "\n\n" << here;
  EXPECT_GT((est.covariance(R) - 4 * there).norm(), 1e-2 * here.norm()) << "the side does not matter here";
}

TEST(ComingFromCeres, BoundsHold) {
  double centre[2] = {0, 0}, radius = 1;
  ceres::Problem problem;
  for (const auto& p : points) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OnCircle, 1, 2, 1>(new OnCircle{p}), nullptr,
                             centre, &radius);
  }
  // clang-format off
  problem.SetParameterLowerBound(&radius, 0, 0.5);
  problem.SetParameterUpperBound(&radius, 0, 2.9);
  // clang-format on
  ceres::Solver::Options there;
  there.function_tolerance = there.parameter_tolerance = 1e-14;
  there.max_num_iterations = 1000;
  ceres::Solver::Summary found;
  ceres::Solve(there, &problem, &found);

  slom::Estimator est;
  auto centre_here = est.insertRV(Eigen::Vector2d(0, 0), "centre");
  {
    auto radius = est.insertRV(1.0, "radius");
    for (const auto& p : points) {
      est.insertMeasurement(
          [](const auto& c, const auto& r, const auto& point) { return (point - c).norm() - r; }, centre_here,
          radius, p, slom::StandardDeviation(0.1));
    }
    // clang-format off
  est.bound(radius, 0.5, 2.9);
    // clang-format on
    const slom::Summary fit = est.optimize();
    EXPECT_TRUE(fit.converged) << fit;
    EXPECT_EQ(*radius, 2.9);
    EXPECT_EQ(fit.active_bounds.size(), 1u);
    EXPECT_NEAR(fit.final_rss, 9.32618, 1e-5) << "with the radius fixed, by another program";
    // Ceres projects its steps onto the bounds, and stops before the centre has followed.
    EXPECT_GT(2 * found.final_cost, fit.final_rss);
    EXPECT_NEAR(2 * found.final_cost, 9.385, 0.01);
  }
  EXPECT_NEAR(radius, 2.9, 1e-9);
  est.bound(centre_here, "x", -1, 1);
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_LE(std::abs(centre_here->x()), 1);
}

TEST(ComingFromCeres, ObserversWatchAFit) {
  double centre[2] = {0, 0}, radius = 1;
  ceres::Problem problem;
  slom::Estimator est;
  const auto c = est.insertRV(Eigen::Vector2d(0, 0), "centre");
  const auto r = est.insertRV(1.0, "radius");
  for (const auto& p : points) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OnCircle, 1, 2, 1>(new OnCircle{p}), nullptr,
                             centre, &radius);
    est.insertMeasurement(
        [](const auto& c, const auto& r, const auto& point) { return (point - c).norm() - r; }, c, r, p,
        slom::StandardDeviation(0.1));
  }
  Watch watch;
  ceres::Solver::Options there;
  there.callbacks.push_back(&watch);
  ceres::Solver::Summary found;
  ceres::Solve(there, &problem, &found);

  std::vector<double> costs;
  // clang-format off
  slom::Options options;
  options.observer = [&](const slom::IterationRecord& record) {
    costs.push_back(record.rss / 2);  // Ceres' cost
    return record.seconds > 60 ? slom::FitControl::stop : slom::FitControl::go_on;
  };
  const slom::Summary summary = est.optimize(options);
  // clang-format on
  ASSERT_EQ(costs.size(), static_cast<std::size_t>(summary.iterations) + 1);
  EXPECT_NEAR(costs.front(), watch.costs.front(), 1e-12 * costs.front());
  EXPECT_NEAR(costs.back(), watch.costs.back(), 1e-6);

  // Variables have the values of the iteration that the record is of.
  est.reinitRV(r, 1.0);
  options.observer = [&](const slom::IterationRecord& record) {
    EXPECT_NEAR(est.getRSS(), record.rss, 1e-9 * record.rss);
    return record.iteration == 1 ? slom::FitControl::stop : slom::FitControl::go_on;
  };
  EXPECT_EQ(est.optimize(options).stop_reason, slom::StopReason::interrupted);
}

}  // namespace
