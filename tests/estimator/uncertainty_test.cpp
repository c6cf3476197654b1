// Covariances of all variables at once, correlations, propagation, and whose word on sigma counts.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

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
    for (int i = 0; i < point_count; ++i) points.push_back(est.insertRV(vec3(3 * normal(engine), 3 * normal(engine), 3 * normal(engine))));
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
    for (int i = 1; i < 4; ++i) compare(marginals.covariance(scene.poses[std::size_t(i)]), C.block(6 * i - 6, 6 * i - 6, 6, 6));
    for (int i = 0; i < points; ++i) {
      const int at = 18 + 3 * i;
      compare(marginals.covariance(scene.points[std::size_t(i)]), C.block(at, at, 3, 3));
      compare(scene.est.covariance(scene.poses[2], scene.points[std::size_t(i)]), C.block(6, at, 6, 3));
    }
    compare(scene.est.covariance(scene.points[4], scene.points[1]), C.block(30, 21, 3, 3));
    const MatrixXd R = scene.est.correlation(scene.poses[1], scene.points[3]);
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(R(i, j), C(i, 27 + j) / std::sqrt(C(i, i) * C(27 + j, 27 + j)), 1e-8);
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
  EXPECT_LT((motion.covariance.topLeftCorner(3, 3) - R.transpose() * own.topLeftCorner(3, 3) * R).norm(), 1e-12);
  EXPECT_LT((motion.covariance.bottomRightCorner(3, 3) - own.bottomRightCorner(3, 3)).norm(), 1e-12);
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
  EXPECT_NE(slom::report(summary).find("chi-square / dof = 7; standard deviations are estimated: those stated, times 2.646\n"),
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
    EXPECT_STREQ(error.what(), "[slom.no-redundancy] uncertainties can be estimated from residuals only when there are more of them "
                               "than unknowns; here are 1 residuals and 1 unknowns; add measurements or use Sigma::known");
  }
}

}  // namespace
