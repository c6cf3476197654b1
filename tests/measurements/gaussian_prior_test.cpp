// GaussianPrior: its information equals that of the measurements it was made of. Also its place in messages and tables.
#include <functional>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "support/random.hpp"

namespace slom::testing {
namespace {

/// Poses that are measured against each other and against points. The first two poses and the first point are
/// marginalised.
struct Map {
  Estimator est;
  DenseQR* solver = new DenseQR;
  std::vector<VarID<SE3>> poses;
  std::vector<VarID<Vec3>> points;
  std::vector<std::function<void()>> remove;  // the measurements of what is to be forgotten

  Map() {
    RandomValues random(7);
    est.changeSolver(std::unique_ptr<LinearSolver>(solver));
    std::vector<SE3> pose_truth;
    std::vector<Vec3> point_truth;
    for (int i = 0; i < 5; ++i) {
      pose_truth.push_back(random.pose(0.6));
      poses.push_back(est.insertRV(pose_truth.back(), "pose " + std::to_string(i)));
    }
    for (int j = 0; j < 4; ++j) {
      point_truth.push_back(random.vector(3));
      points.push_back(est.insertRV(point_truth.back(), "point " + std::to_string(j)));
    }
    const auto see = [&](std::size_t i, std::size_t j, std::string_view label) {
      return est.insertMeasurement(
          Landmark(), poses[i], points[j],
          measured(Vec3(pose_truth[i].inverse() * point_truth[j] + random.vector(0.05))),
          StandardDeviation(0.05), named(label));
    };
    const auto move = [&](std::size_t i, std::size_t j, std::string_view label) {
      return est.insertMeasurement(RelativePose(), poses[i], poses[j],
                                   measured(SE3(pose_truth[i].inverse() * pose_truth[j] * random.pose(0.01))),
                                   StandardDeviation(0.02), named(label));
    };
    const auto forget = [&](auto id) { remove.emplace_back([this, id] { est.removeMeasurement(id); }); };
    forget(est.prior(poses[0], pose_truth[0], 0.01));
    for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(1, 4), std::pair(0, 3)})
      forget(move(static_cast<std::size_t>(i), static_cast<std::size_t>(j), "old motion"));
    for (std::size_t j = 0; j < 4; ++j) {
      forget(see(0, j, "old sight"));
      forget(see(1, j, "old sight"));
    }
    move(2, 3, "motion");
    move(3, 4, "motion");
    for (std::size_t i = 2; i < 5; ++i) {
      for (std::size_t j = 1; j < 4; ++j) see(i, j, "sight");
    }
  }
};

/// The rows of J and r that come first, as R and b of the unknowns `rest` once the others have been eliminated by QR.
std::pair<MatrixXd, VectorXd> eliminated(const MatrixXd& J, const VectorXd& r, int rows,
                                         const std::vector<int>& gone, const std::vector<int>& rest) {
  MatrixXd A(rows, J.cols() + 1);
  Eigen::Index column = 0;
  for (const std::vector<int>* part : {&gone, &rest}) {
    for (const int c : *part) A.col(column++) = J.col(c).head(rows);
  }
  A.col(column) = r.head(rows);
  const MatrixXd R = A.householderQr().matrixQR().triangularView<Eigen::Upper>();
  const Eigen::Index first = static_cast<Eigen::Index>(gone.size()),
                     n = static_cast<Eigen::Index>(rest.size());
  const Eigen::Index height = std::min(R.rows() - first, n);
  return {R.block(first, first, height, n), R.block(first, J.cols(), height, 1)};
}

TEST(GaussianPrior, StandsForTheMeasurementsThatItWasMadeOf) {
  Map map;
  Estimator& est = map.est;
  for (int i = 0; i < 20; ++i) est.optimizeStep();
  const std::vector<SE3> fitted{*map.poses[2], *map.poses[3], *map.poses[4]};
  const MatrixXd covariance = est.covariance(map.poses[3]),
                 between = est.covariance(map.poses[2], map.points[2]);
  est.optimizeStep();  // linearises at the optimum
  const MatrixXd J = map.solver->jacobian();
  const VectorXd r = map.solver->residual();
  ASSERT_EQ(J.cols(), 5 * 6 + 4 * 3);
  std::vector<int> gone, rest;
  for (int c = 0; c < J.cols(); ++c) (c < 12 || (c >= 30 && c < 33) ? gone : rest).push_back(c);
  const int old_rows = 6 + 4 * 6 + 8 * 3;
  const auto [R, b] = eliminated(J, r, old_rows, gone, rest);

  for (const auto& remove : map.remove) remove();
  est.removeRV(map.poses[0]);
  est.removeRV(map.poses[1]);
  est.removeRV(map.points[0]);
  const auto prior = est.insertMeasurement(GaussianPrior(
      {map.poses[2], map.poses[3], map.poses[4], map.points[1], map.points[2], map.points[3]}, R, b));
  const Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(mtk::difference(*map.poses[2 + i], fitted[i]).norm(), 1e-9);
  EXPECT_LT((est.covariance(map.poses[3]) - covariance).norm(), 1e-8 * covariance.norm());
  EXPECT_LT((est.covariance(map.poses[2], map.points[2]) - between).norm(), 1e-8 * between.norm());
  EXPECT_TRUE(checkDerivatives(est).ok()) << checkDerivatives(est);

  EXPECT_EQ(est.residual(prior).size(), R.rows());
  EXPECT_NEAR(est.getRSS(prior), est.residual(prior).squaredNorm(), 1e-12);
  EXPECT_EQ(est.getRSS<GaussianPrior>(), est.getRSS(prior));
  EXPECT_EQ(est.weight(prior), 1);
  est.removeMeasurement(prior);
  EXPECT_THROW(est.covariance(map.poses[3]), Error);  // nothing but the motions between them is left
}

TEST(GaussianPrior, HasExactDerivativesAwayFromItsPoint) {
  RandomValues random(3);
  Estimator est;
  const auto pose = est.insertRV(random.pose(1));
  const auto direction = est.insertRV(mtk::S2<>(1, 2, 3));
  const auto numbers = est.insertRV(Eigen::VectorXd(VectorXd::LinSpaced(4, -1, 1)));
  const auto id = est.insertMeasurement(
      GaussianPrior({pose, direction, numbers, pose}, random.matrix(5, 18), random.matrix(5, 1))
          .linearizedAt(pose, random.pose(1))
          .linearizedAt(direction, mtk::S2<>(3, -1, 1))
          .linearizedAt(numbers, VectorXd::Zero(4)));
  EXPECT_EQ(est.residual(id).size(), 5);
  const DerivativeCheck check = checkDerivatives(est);
  ASSERT_EQ(check.groups.size(), 1u);
  EXPECT_EQ(check.groups[0].group, "GaussianPrior");
  EXPECT_EQ(check.groups[0].source, DerivativeSource::exact);
  EXPECT_LT(check.groups[0].error, 1e-8) << check;
}

TEST(GaussianPrior, MayBeRankDeficientOrEmpty) {
  Estimator est;
  const auto x = est.insertRV(1.0, "x"), y = est.insertRV(2.0, "y");
  MatrixXd sum(3, 2);
  sum << 1, 1, 2, 2, 0, 0;
  est.insertMeasurement(GaussianPrior({x, y}, sum, Eigen::Vector3d(-1, -2, 0)));
  const auto nothing = est.insertMeasurement(GaussianPrior({x, y}, MatrixXd(0, 2)));
  EXPECT_EQ(est.residual(nothing).size(), 0);
  const Diagnosis diagnosis = diagnose(est);
  ASSERT_EQ(diagnosis.findings.size(), 1u) << diagnosis;
  EXPECT_EQ(
      diagnosis.findings[0].text,
      "x and y cannot be told apart: moving them by +1 and -1 changes no residual, to first order; fix one of them, or add a "
      "prior or measurements that depend on them in another way");
  est.insertMeasurement(GaussianPrior({y}, MatrixXd::Constant(1, 1, 10)).linearizedAt(y, 5));
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*y, 5, 1e-12);
  EXPECT_NEAR(*x, -1, 1e-12);
  EXPECT_NEAR(est.covariance(x)(0, 0), 0.2 + 0.01, 1e-12);
}

TEST(GaussianPrior, OfAllArityIsOneGroup) {
  Estimator est;
  const auto a = est.insertRV(Vec3(1, 2, 3), "a"), b = est.insertRV(Vec3(1, 0, 0), "b");
  const auto c = est.insertRV(0.5, "c");
  const MatrixXd I = MatrixXd::Identity(7, 7);
  const auto all = est.insertMeasurement(GaussianPrior({a, b, c}, I), Huber(2));
  est.insertMeasurement(GaussianPrior({a}, I.topLeftCorner(3, 3), Vec3(3, 0, 0)), Huber(2));
  est.insertMeasurement(GaussianPrior({c, c}, 2 * MatrixXd::Identity(2, 2)));
  est.insertMeasurement(GaussianPrior({b}, 2 * I.topLeftCorner(3, 3)), named("of b"));
  EXPECT_EQ(est.weight(all), 1);
  const Summary summary = est.optimize();
  ASSERT_EQ(summary.groups.size(), 2u) << summary;
  EXPECT_EQ(summary.groups[0].name, "GaussianPrior");
  EXPECT_EQ(summary.groups[0].measurements, 3);
  EXPECT_EQ(summary.groups[0].residuals, 12);
  EXPECT_EQ(summary.groups[0].derivatives, "exact");
  ASSERT_EQ(summary.groups[0].losses.size(), 1u);
  EXPECT_EQ(summary.groups[0].losses[0].measurements, 2);
  EXPECT_EQ(summary.groups[1].name, "of b");
  EXPECT_NEAR(summary.groups[0].initial_rss, 8, 1e-12);  // Huber: 2 * 2 * 3 - 4
  EXPECT_NEAR(summary.groups[0].redundancy + summary.groups[1].redundancy, 15 - 7, 1e-9);
  const OutlierReport report = outliers(est);
  ASSERT_EQ(report.groups.size(), 2u);
  EXPECT_EQ(report.groups[0].measurements, 3);
  EXPECT_EQ(report.groups[0].worst[0].measurement.substr(0, 15), "GaussianPrior #");
  const Preflight preflight = slom::preflight(est);
  ASSERT_EQ(preflight.groups.size(), 2u);
  EXPECT_EQ(preflight.groups[0].measurements, 3);
  EXPECT_EQ(preflight.derivatives.groups.size(), 2u);

  est.removeMeasurement(all);
  EXPECT_THROW(est.residual(all), Error);
  EXPECT_EQ(est.optimize().groups[0].measurements, 2);
  est.fix(a);
  est.fix(b);
  est.fix(c);
  EXPECT_EQ(
      diagnose(est).findings[0].text,
      "2 of 2 measurements GaussianPrior depend on fixed variables alone: they count in chi-square and redundancy, "
      "but determine nothing");
}

TEST(GaussianPrior, IsCopiedWithItsPoint) {
  Estimator est;
  const auto x = est.insertRV(SO3(), "x");
  GaussianPrior a({x}, MatrixXd::Identity(3, 3)), b = a;
  b.linearizedAt(x, SO3::exp(Vec3(0.1, 0, 0)));
  EXPECT_EQ(est.residual(est.insertMeasurement(a)), VectorXd::Zero(3));
  a = b;
  EXPECT_NEAR(est.residual(est.insertMeasurement(a))[0], -0.1, 1e-15);
  const GaussianPrior moved(std::move(a));
  EXPECT_NEAR(est.residual(est.insertMeasurement(moved))[0], -0.1, 1e-15);
}

TEST(GaussianPrior, OutlivesTheEstimator) {
  const GaussianPrior prior = [] {
    Estimator est;
    const auto x = est.insertRV(std::vector<double>().empty() ? 1.0 : 2.0);
    return GaussianPrior({x}, MatrixXd::Identity(1, 1));
  }();
  EXPECT_EQ(prior.variables()[0].as<double>(), 1);
  Estimator other;
  EXPECT_EQ(
      messageOf([&] { other.insertMeasurement(prior); }),
      "[slom.foreign-handle] the VarID<double> belongs to another estimator; use it only with the estimator whose "
      "insertRV returned it");
}

TEST(GaussianPrior, RefusesWhatDoesNotFit) {
  Estimator est;
  const auto a = est.insertRV(Vec3(), "a");
  const auto c = est.insertRV(0.5, "c");
  const auto numbers = est.insertRV(Eigen::VectorXd(VectorXd::Zero(2)));
  const auto gone = est.insertRV(1.0);
  est.removeRV(gone);
  const MatrixXd I = MatrixXd::Identity(4, 4);
  EXPECT_EQ(
      messageOf([&] { GaussianPrior(std::vector<AnyVarID>(), MatrixXd(0, 0)); }),
      "[slom.no-variables] the GaussianPrior has no variables, its list is empty; pass the VarID of at least one");
  EXPECT_EQ(
      messageOf([&] {
        GaussianPrior({a, gone}, I);
      }),
      "[slom.stale-handle] the VarID<double> refers to a variable that has been removed; keep the VarID that "
      "insertRV returned last");
  EXPECT_EQ(messageOf([&] {
              GaussianPrior({a, VarID<Vec3>()}, I);
            }),
            "[slom.stale-handle] the AnyVarID refers to no variable; assign it the result of insertRV first");
  EXPECT_EQ(
      messageOf([&] {
        GaussianPrior({a, c}, MatrixXd::Identity(3, 3));
      }),
      "[slom.prior-size] the GaussianPrior over 2 variables with 4 degrees of freedom has a matrix R with 3 columns; "
      "pass one with a column for each degree of freedom");
  EXPECT_EQ(
      messageOf([&] { GaussianPrior({c}, MatrixXd::Identity(1, 1), VectorXd::Zero(2)); }),
      "[slom.prior-size] the GaussianPrior over 1 variable with 1 degree of freedom has an offset b of length 2 for 1 "
      "row of R; pass one number for each row, or no offset");
  MatrixXd bad = I;
  bad(2, 1) = std::nan("");
  EXPECT_EQ(
      messageOf([&] {
        GaussianPrior({a, c}, bad);
      }),
      "[slom.prior-not-finite] the GaussianPrior over 2 variables with 4 degrees of freedom has R(2, 1) = nan; pass "
      "finite numbers");
  EXPECT_EQ(
      messageOf([&] {
        GaussianPrior({a, c}, I, Eigen::Vector4d(0, 0, 0, INFINITY));
      }),
      "[slom.prior-not-finite] the GaussianPrior over 2 variables with 4 degrees of freedom has b(3) = inf; pass "
      "finite numbers");
  GaussianPrior prior({a, numbers}, MatrixXd::Identity(5, 5));
  EXPECT_EQ(
      messageOf([&] { prior.linearizedAt(c, 1); }),
      "[slom.not-in-list] the VarID<double> is none of the variables of the GaussianPrior over 2 variables with 5 "
      "degrees of freedom; give linearisation points to its own variables");
  EXPECT_EQ(
      messageOf([&] { prior.linearizedAt(numbers, VectorXd::Zero(3)); }),
      "[slom.size-change] the variable of the GaussianPrior over 2 variables with 5 degrees of freedom has 2 degrees "
      "of freedom, the linearisation point has 3; give a value of the variable's size");
  EXPECT_EQ(
      messageOf([&] { prior.linearizedAt(numbers, Eigen::Vector2d(0, std::nan(""))); }),
      "[slom.prior-not-finite] the linearisation point of variable 1 of the GaussianPrior over 2 variables with 5 "
      "degrees of freedom is not finite; pass finite numbers");
  const auto late = est.insertRV(1.0);
  const GaussianPrior stale({late}, MatrixXd::Identity(1, 1));
  est.removeRV(late);
  EXPECT_EQ(
      messageOf([&] { est.insertMeasurement(stale); }),
      "[slom.stale-handle] the VarID<double> refers to a variable that has been removed; keep the VarID that "
      "insertRV returned last");
  EXPECT_EQ(
      messageOf([&] { est.insertMeasurement(prior, StandardDeviation(-1)); }),
      "[slom.not-positive-definite] standard deviation of measurement GaussianPrior #1 is -1; pass positive finite numbers");
  EXPECT_EQ(est.getM(), 0);
  EXPECT_TRUE(est.optimize().groups.empty());  // what failed left no group behind
}

}  // namespace
}  // namespace slom::testing
