// Covariances of all variables at once, correlations, propagation, and the source of sigma.
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/solve/block_solver.hpp>

namespace {

using Eigen::MatrixXd;
using SE3 = mtk::trafo<mtk::SO3<>>;
using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;

/// Four poses, the first fixed, 80 points seen from all of them: enough points for the Schur complement.
struct Scene {
  slom::Estimator est;
  std::vector<slom::VarID<SE3>> poses;
  std::vector<slom::VarID<vec3>> points;

  explicit Scene(int point_count) {
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 4; ++i) {
      SE3 pose(vec3(i, 0.1 * normal(engine), 0));
      pose.orient = mtk::SO3<>::exp(0.3 * vec3(normal(engine), normal(engine), normal(engine)));
      poses.push_back(est.insertRV(pose, i > 0));
    }
    for (int i = 0; i < point_count; ++i)
      points.push_back(est.insertRV(vec3(3 * normal(engine), 3 * normal(engine), 3 * normal(engine))));
    for (const auto& pose : poses) {
      for (const auto& point : points) {
        const auto seen = [](const auto& T, const auto& p) { return T.inverse() * p; };
        const vec3 z = seen(*pose, *point) + 0.01 * vec3(normal(engine), normal(engine), normal(engine));
        est.insertMeasurement(seen, pose, point, slom::measured(z), slom::StandardDeviation(0.01));
      }
    }
    EXPECT_TRUE(est.optimize().converged);
  }
};

/// All variables' blocks of (J^T J)^-1, J by differences of the whole residual vector.
MatrixXd inverseNormalMatrix(Scene& scene) {
  slom::Estimator& est = scene.est;
  MatrixXd J(est.getM(), est.getN());
  int column = 0;
  const auto differentiate = [&](const auto& id) {
    const auto x = *id;
    using X = std::decay_t<decltype(x)>;
    for (int c = 0; c < mtk::DOF_v<X>; ++c, ++column) {
      mtk::tangent_t<X> d = mtk::tangent_t<X>::Zero();
      const double h = 1e-5;
      d[c] = h;
      est.reinitRV(id, mtk::moved<X>(x, d));
      J.col(column) = est.residuals();
      est.reinitRV(id, mtk::moved<X>(x, d, -1));
      J.col(column) = (J.col(column) - est.residuals()) / (2 * h);
    }
    est.reinitRV(id, x);
  };
  for (std::size_t i = 1; i < scene.poses.size(); ++i) differentiate(scene.poses[i]);
  for (const auto& id : scene.points) differentiate(id);
  return (J.transpose() * J).inverse();
}

TEST(Uncertainty, OfAllVariablesAgreesWithTheDenseInverse) {
  for (const int points : {5, 80}) {
    Scene scene(points);
    const MatrixXd C = inverseNormalMatrix(scene);
    const slom::Marginals marginals = scene.est.marginals();
    EXPECT_EQ(marginals.covariance(scene.poses[0]), MatrixXd::Zero(6, 6));
    const auto compare = [&](const MatrixXd& covariance, const MatrixXd& expected) {
      EXPECT_LT((covariance - expected).norm(), 1e-8 * expected.norm());
    };
    for (int i = 1; i < 4; ++i)
      compare(marginals.covariance(scene.poses[std::size_t(i)]), C.block(6 * i - 6, 6 * i - 6, 6, 6));
    for (int i = 0; i < points; ++i) {
      const int at = 18 + 3 * i;
      compare(marginals.covariance(scene.points[std::size_t(i)]), C.block(at, at, 3, 3));
      compare(scene.est.covariance(scene.poses[2], scene.points[std::size_t(i)]), C.block(6, at, 6, 3));
    }
    compare(scene.est.covariance(scene.points[4], scene.points[1]), C.block(30, 21, 3, 3));
    const MatrixXd R = scene.est.correlation(scene.poses[1], scene.points[3]);
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(R(i, j), C(i, 27 + j) / std::sqrt(C(i, i) * C(27 + j, 27 + j)), 1e-8);
    }
    EXPECT_EQ(scene.est.correlation(scene.poses[0], scene.points[3]), MatrixXd::Zero(6, 3));
  }
}

TEST(Uncertainty, IsPropagatedThroughFunctions) {
  Scene scene(5);
  const MatrixXd C = inverseNormalMatrix(scene);
  const auto distance = [](const auto& a, const auto& b) { return (a.pos - b.pos).norm(); };
  const auto result = scene.est.propagate(distance, scene.poses[1], scene.poses[3]);
  EXPECT_EQ(result.value, distance(*scene.poses[1], *scene.poses[3]));
  Eigen::RowVectorXd J = Eigen::RowVectorXd::Zero(33);
  const vec3 direction = (scene.poses[1]->pos - scene.poses[3]->pos).normalized();
  J.segment<3>(0) = direction;
  J.segment<3>(12) = -direction;
  EXPECT_NEAR(result.standardDeviation()[0], std::sqrt((J * C * J.transpose())(0, 0)), 1e-8);

  // A manifold, of a fixed variable and a free one: both ways round the same uncertainty, seen from other frames.
  const auto relative = [](const auto& a, const auto& b) { return a.inverse() * b; };
  const auto motion = scene.est.propagate(relative, scene.poses[0], scene.poses[1]);
  EXPECT_LT(mtk::difference(motion.value, scene.poses[0]->inverse() * *scene.poses[1]).norm(), 1e-12);
  const MatrixXd R = scene.poses[0]->orient.toRotationMatrix();
  const MatrixXd own = scene.est.covariance(scene.poses[1]);
  EXPECT_LT((motion.covariance.topLeftCorner(3, 3) - R.transpose() * own.topLeftCorner(3, 3) * R).norm(),
            1e-12);
  EXPECT_LT((motion.covariance.bottomRightCorner(3, 3) - own.bottomRightCorner(3, 3)).norm(), 1e-12);
}

/// In a poorly determined direction, an iterative solver ends with 1.4 in place of 5e8.
TEST(Uncertainty, OfASolverThatIteratesIsThatOfOneThatFactorises) {
  using Options = slom::BlockSolverOptions;
  const auto deviations = [](double sigma, std::unique_ptr<slom::LinearSolver> solver) {
    slom::Estimator est;
    est.changeSolver(std::move(solver));
    const auto a = est.insertRV(1.0), b = est.insertRV(2.0), c = est.insertRV(0.5);
    const auto sum = [](const auto& x, const auto& y) { return x + y; };
    const auto difference = [](const auto& x, const auto& y) { return x - y; };
    est.insertMeasurement(sum, a, b, slom::measured(3.0), slom::StandardDeviation(1));
    est.insertMeasurement(difference, a, b, slom::measured(-1.0), slom::StandardDeviation(sigma));
    est.insertMeasurement(difference, c, b, slom::measured(-1.5), slom::StandardDeviation(1));
    EXPECT_TRUE(est.optimize().converged);
    EXPECT_TRUE(slom::diagnose(est).isDetermined());
    return Eigen::Vector2d(est.standardDeviation(a)[0], est.marginals().standardDeviation(c)[0]);
  };
  for (const double sigma : {1e2, 1e4, 1e6, 1e8, 1e9}) {
    const Eigen::Vector2d s = deviations(
        sigma, std::make_unique<slom::BlockSolver>(Options{.method = Options::Method::conjugate_gradients}));
    const double variance = (sigma * sigma + 1) / 4;  // of (sum + difference) / 2
    EXPECT_NEAR(s[0] / std::sqrt(variance), 1, 1e-6) << sigma;
    EXPECT_NEAR(s[1] / std::sqrt(variance + 1), 1, 1e-6) << sigma;
  }
}

TEST(Uncertainty, OfAFreeNetworkIsThePseudoInverse) {
  slom::Estimator est;
  std::mt19937 engine(6);
  std::normal_distribution<double> normal;
  std::vector<slom::VarID<vec2>> points;
  for (int i = 0; i < 5; ++i)
    points.push_back(
        est.insertRV(vec2(10 * normal(engine), 10 * normal(engine)), "point " + std::to_string(i)));
  const auto distance = [](const auto& a, const auto& b) { return (a - b).norm(); };
  MatrixXd J(10, 10);
  int row = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; j < i; ++j, ++row) {
      est.insertMeasurement(distance, points[i], points[j], slom::measured(distance(*points[i], *points[j])));
      const vec2 direction = (*points[i] - *points[j]).normalized();
      J.row(row).setZero();
      J.row(row).segment<2>(2 * static_cast<int>(i)) = direction;
      J.row(row).segment<2>(2 * static_cast<int>(j)) = -direction;
    }
  }
  const MatrixXd H = J.transpose() * J;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(H);
  Eigen::VectorXd inverse = eigen.eigenvalues().cwiseInverse();
  inverse.head(3).setZero();  // two translations, a rotation
  const MatrixXd C = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  EXPECT_THROW(est.covariance(points[0]), mtk::Error);
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  const slom::Marginals marginals = est.marginals();
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT((est.covariance(points[std::size_t(i)]) - C.block(2 * i, 2 * i, 2, 2)).norm(), 1e-9);
    EXPECT_LT((marginals.covariance(points[std::size_t(i)]) - C.block(2 * i, 2 * i, 2, 2)).norm(), 1e-9);
    EXPECT_LT((est.covariance(points[std::size_t(i)], points[2]) - C.block(2 * i, 4, 2, 2)).norm(), 1e-9);
  }
  // What does not depend on the gauge is the same as with two points fixed as far as it takes.
  const double free = est.propagate(distance, points[1], points[3]).standardDeviation()[0];
  est.setFreeGauge(slom::FreeGauge::error);
  est.fix(points[0]);
  est.fix(points[4], "x");
  EXPECT_NEAR(free, est.propagate(distance, points[1], points[3]).standardDeviation()[0], 1e-9);
  // Only a gauge may be free.
  est.free(points[0]);
  est.free(points[4]);
  est.insertRV(1.0, "clock");
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  EXPECT_THROW(est.covariance(points[0]), mtk::Error);
}

/// Distances between points in the plane, with errors: place and direction of all are free.
struct Trilateration {
  slom::Estimator est;
  std::vector<slom::VarID<vec2>> points;

  explicit Trilateration(int count, double sigma = 0.01) {
    std::mt19937 engine(8);
    std::normal_distribution<double> normal;
    for (int i = 0; i < count; ++i)
      points.push_back(
          est.insertRV(vec2{10 * normal(engine), 10 * normal(engine)}, "point " + std::to_string(i)));
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        est.insertMeasurement(distance, points[i], points[j],
                              slom::measured(distance(*points[i], *points[j]) + sigma * normal(engine)),
                              slom::StandardDeviation(sigma));
    }
    est.changeAlgorithm(new slom::LevenbergMarquardt);
  }

  static constexpr auto distance = [](const auto& a, const auto& b) { return (a - b).norm(); };
};

/// The redundancy, and so the variance factor, depends neither on the choice of the datum nor on whether there is one.
TEST(Uncertainty, RedundancyIsThatOfTheRankOfJ) {
  for (const int count : {4, 5, 9}) {
    Trilateration network(count);
    slom::Estimator& est = network.est;
    est.setSigma(slom::Sigma::estimated);
    est.setFreeGauge(slom::FreeGauge::inner_constraints);
    const slom::Summary free = est.optimize();
    EXPECT_TRUE(free.converged) << free;
    EXPECT_EQ(free.free_directions, 3);
    EXPECT_EQ(free.redundancy, count * (count - 1) / 2 - (2 * count - 3));
    const auto deviation = [&] {
      return est.propagate(Trilateration::distance, network.points[0], network.points[1])
          .standardDeviation()[0];
    };
    const double estimated = deviation();
    const double of_groups = free.groups.at(0).redundancy;
    est.setFreeGauge(slom::FreeGauge::error);
    est.fix(network.points[0]);
    est.fix(network.points[1], "x");
    const slom::Summary fixed = est.optimize();
    EXPECT_EQ(fixed.free_directions, 0);
    EXPECT_EQ(fixed.redundancy, free.redundancy);
    EXPECT_NEAR(fixed.chi2PerDof(), free.chi2PerDof(), 1e-9 * free.chi2PerDof());
    EXPECT_NEAR(deviation(), estimated, 1e-9 * estimated);
    EXPECT_NEAR(of_groups, fixed.redundancy, 1e-6);
  }
}

TEST(Uncertainty, ReportCountsFreeDirections) {
  Trilateration network(4);
  const std::string text = network.est.optimize().report();
  EXPECT_NE(text.find("\n  6 residuals - 8 unknowns (4 variables) + 3 free directions = redundancy 1\n"),
            std::string::npos)
      << text;
}

TEST(Uncertainty, NoRedundancyNamesFreeDirections) {
  Trilateration network(0);
  const std::vector<vec2> triangle{vec2(0, 0), vec2(10, 0), vec2(3, 7)};
  for (const vec2& p : triangle) network.points.push_back(network.est.insertRV(p));
  for (std::size_t i = 0; i < 3; ++i)
    network.est.insertMeasurement(Trilateration::distance, network.points[i], network.points[(i + 1) % 3],
                                  slom::measured(10.0));
  network.est.optimize();
  network.est.setSigma(slom::Sigma::estimated);
  network.est.setFreeGauge(slom::FreeGauge::inner_constraints);
  try {
    static_cast<void>(network.est.covariance(network.points[0]));
    FAIL();
  } catch (const mtk::Error& error) {
    EXPECT_STREQ(
        error.what(),
        "[slom.no-redundancy] Sigma::estimated needs more residuals than unknowns, but there are 3 residuals "
        "and 6 unknowns, 3 directions of them free; add "
        "measurements or use Sigma::known");
  }
}

TEST(Profile, OfALinearModelIsTheQuantileOfTheNormalDistributionOrStudents) {
  slom::Estimator est;
  const auto line = est.insertRV(vec2(0, 0), "line");
  for (int i = 0; i < 5; ++i) {
    est.insertMeasurement([x = double(i), z = double(i * i)](const auto& c) { return c[0] + c[1] * x - z; },
                          line);
  }
  EXPECT_TRUE(est.optimize().converged);
  const vec2 fitted = *line;
  for (const int c : {0, 1}) {
    const slom::ProfileInterval interval = slom::profile(est, line, c == 0 ? "x" : "y");
    const double half = 1.959963984540054 * est.standardDeviation(line)[c];
    EXPECT_EQ(interval.value, fitted[c]);
    EXPECT_NEAR(interval.upper, fitted[c] + half, 1e-6 * half);
    EXPECT_NEAR(interval.lower, fitted[c] - half, 1e-6 * half);
    EXPECT_EQ(*line, fitted);
    EXPECT_EQ(est.getN(), 2);
  }
  est.setSigma(slom::Sigma::estimated);
  const double half = 3.182446305284263 * est.standardDeviation(line)[0];  // three degrees of freedom
  EXPECT_NEAR(slom::profile(est, line, "x").upper, fitted[0] + half, 1e-6 * half);
}

/// Michaelis and Menten's curve, whose intervals are asymmetric. At the ends, the RSS from a fine search over the other
/// parameter is above the minimum by the quantile. An end at infinity is reported as such.
TEST(Profile, OfACurveIsLopsided) {
  slom::Estimator est;
  const auto p = est.insertRV(vec2(200, 0.1), "enzyme");
  const std::vector<vec2> data{{0.02, 76}, {0.06, 97}, {0.11, 123}, {0.22, 159}, {0.56, 191}, {1.1, 207}};
  const auto rss = [&](double v, double k) {
    double sum = 0;
    for (const vec2& d : data) sum += std::pow((v * d[0] / (k + d[0]) - d[1]) / 10, 2);
    return sum;
  };
  for (const vec2& d : data) {
    est.insertMeasurement([d](const auto& c) { return c[0] * d[0] / (c[1] + d[0]) - d[1]; }, p,
                          slom::StandardDeviation(10));
  }
  EXPECT_TRUE(est.optimize().converged);
  const double best = est.getRSS();
  const slom::ProfileInterval interval = slom::profile(est, p, "y");
  EXPECT_GT(interval.upper - interval.value, 1.05 * (interval.value - interval.lower));
  for (const double k : {interval.lower, interval.upper}) {
    double least = std::numeric_limits<double>::infinity();
    for (double v = 150; v < 300; v += 0.002) least = std::min(least, rss(v, k));
    EXPECT_NEAR(least - best, 3.841458820694124, 1e-5);
  }
  slom::Estimator open;
  const auto x = open.insertRV(1.0, "x");
  open.insertMeasurement([](const auto& v) { return 1 / v - 1; }, x);  // bounded by 1 as x grows
  open.optimize();
  EXPECT_EQ(slom::profile(open, x).upper, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(slom::profile(open, x).lower, 1 / (1 + 1.959963984540054), 1e-6);
}

/// r = (x - z) / sigma has its interval in closed form: z +- 1.96 sigma, cut by the bound. If z is beyond the bound b,
/// the end t has (t - z)^2 - (b - z)^2 = (1.96 sigma)^2.
TEST(Profile, EndsAtBounds) {
  const double q = 1.959963984540054, inf = std::numeric_limits<double>::infinity();
  struct Case {
    double z, lower, upper, expected_lower, expected_upper;
  };
  const Case cases[] = {{1, 0, 10, 0, 1 + q},                        // cut below
                        {9, 0, 10, 9 - q, 10},                       // cut above
                        {0.5, 0, 1, 0, 1},                           // cut on both sides
                        {5, 0, 10, 5 - q, 5 + q},                    // far from both
                        {-1, 0, 10, 0, -1 + std::sqrt(1 + q * q)},   // at the lower one
                        {12, 0, 10, 12 - std::sqrt(4 + q * q), 10},  // at the upper one
                        {-1, 0, inf, 0, -1 + std::sqrt(1 + q * q)},  // no other
                        {-1, 0, 0.5, 0, 0.5},                        // at one, cut at the other
                        {3, 4, 4, 4, 4}};                            // both are active
  for (const Case& c : cases) {
    slom::Estimator est;
    const auto x = est.insertRV(std::clamp(5.0, c.lower, c.upper), "x"), y = est.insertRV(0.0, "y");
    est.insertMeasurement([z = c.z](const auto& v) { return v - z; }, x);
    est.insertMeasurement([](const auto& v, const auto& w) { return v + w - 3.0; }, x, y);
    est.bound(x, c.lower, c.upper);
    ASSERT_TRUE(est.optimize().converged);
    const double fitted = *x, other = *y;
    const slom::ProfileInterval interval = slom::profile(est, x);
    EXPECT_NEAR(interval.value, std::clamp(c.z, c.lower, c.upper), 1e-9);
    EXPECT_NEAR(interval.lower, c.expected_lower, 1e-6)
        << c.z << " in [" << c.lower << ", " << c.upper << "]";
    EXPECT_NEAR(interval.upper, c.expected_upper, 1e-6)
        << c.z << " in [" << c.lower << ", " << c.upper << "]";
    EXPECT_EQ(*x, fitted);
    EXPECT_EQ(*y, other);
    const slom::Summary again = est.optimize();  // the bound is still there
    EXPECT_EQ(again.active_bounds.size(), c.z < c.lower || c.z > c.upper ? 1u : 0u) << c.z;
    EXPECT_NEAR(*x, fitted, 1e-14);
  }
}

TEST(Profile, FaultsAreNamed) {
  slom::Estimator est;
  const auto pose = est.insertRV(SE3(), "pose");
  est.prior(pose, SE3(vec3(1, 0, 0)), 1);
  const auto messageOf = [](const auto& f) -> std::string {
    try {
      f();
    } catch (const mtk::Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(
      messageOf([&] { slom::profile(est, pose, "pos.x"); }),
      "[slom.not-a-minimum] the profile of pose.pos.x needs the values of a converged fit; call optimize() "
      "first");
  EXPECT_EQ(
      messageOf([&] { slom::profile(est, pose, "pos"); }),
      "[slom.no-component] pos of variable pose is not one coordinate; profile takes one component of a vector at a time");
  EXPECT_EQ(
      messageOf([&] { slom::profile(est, pose, "pos.x", 95); }),
      "[slom.bad-option] the probability of a profile interval is 95; pass one between 0 and 1, such as 0.95");
}

TEST(Uncertainty, IsEstimatedWhenAsked) {
  slom::Estimator est;
  const auto mean = est.insertRV(0.0, "mean");
  for (const double z : {1.0, 2.0, 6.0}) est.insertMeasurement([z](const auto& x) { return x - z; }, mean);
  est.optimize();
  EXPECT_NEAR(est.standardDeviation(mean)[0], std::sqrt(1.0 / 3), 1e-12);
  est.setSigma(slom::Sigma::estimated);
  EXPECT_NEAR(est.standardDeviation(mean)[0], std::sqrt(14.0 / 2 / 3), 1e-12);  // RSS 14, redundancy 2
  EXPECT_NEAR(est.marginals().standardDeviation(mean)[0], std::sqrt(14.0 / 2 / 3), 1e-12);
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.sigma_is_estimated);
  EXPECT_NE(slom::report(summary).find(
                "chi-square / dof = 7; standard deviations are estimated: 2.646 for each residual\n"),
            std::string::npos)
      << slom::report(summary);

  slom::Estimator exact;
  const auto x = exact.insertRV(0.0);
  exact.insertMeasurement([](const auto& v) { return v - 1; }, x);
  exact.setSigma(slom::Sigma::estimated);
  try {
    exact.covariance(x);
    FAIL();
  } catch (const mtk::Error& error) {
    EXPECT_STREQ(
        error.what(),
        "[slom.no-redundancy] Sigma::estimated needs more residuals than unknowns, but there are 1 residuals "
        "and 1 unknowns; add measurements or use Sigma::known");
  }
}

}  // namespace
