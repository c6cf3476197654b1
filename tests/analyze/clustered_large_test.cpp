// Clustered covariances with leverages from selected inversion or from columns of the inverse, with losses, and for
// many groups.
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/clustered.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/solve/forwarding_solver.hpp>

#include "support/fresh_seed.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using slom::ClusterCorrection;
using vec2 = mtk::vect<2>;
using SE2 = mtk::trafo<mtk::SO2<>>;

const auto difference = [](const auto& a, const auto& b) { return b - a; };
const auto is = [](const auto& x) { return x; };

/// Points in the plane, measured by random differences of two. Both coordinates have the same J, so one J is enough.
struct Network {
  slom::Estimator est;
  std::vector<slom::VarID<vec2>> points;
  MatrixXd J;  // measurements x points
  std::vector<int> group;

  Network(int count, int measurements, int per_group) : J(MatrixXd::Zero(measurements, count)) {
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    for (int i = 0; i < count; ++i) points.push_back(est.insertRV(vec2(0, 0)));
    for (int m = 0; m < measurements; ++m) {
      // a star, so that all are determined, and random pairs
      const int a = m < count ? m : static_cast<int>(engine() % static_cast<unsigned>(count));
      int b = m < count ? -1 : static_cast<int>(engine() % static_cast<unsigned>(count - 1));
      if (b >= a) ++b;
      const auto& A = points[static_cast<std::size_t>(a)];
      const vec2 z(normal(engine), normal(engine));
      group.push_back(m / per_group);
      J(m, a) = -1;
      if (b < 0) {
        J(m, a) = 1;
        est.insertMeasurement(is, A, slom::measured(z), slom::group(group.back()));
      } else {
        J(m, b) = 1;
        est.insertMeasurement(difference, A, points[static_cast<std::size_t>(b)], slom::measured(z),
                              slom::group(group.back()));
      }
    }
    EXPECT_TRUE(est.optimize().converged);
  }
};

struct Dense {
  Eigen::Matrix2d C = Eigen::Matrix2d::Zero();
  double dof = 0;
};

/// CR2 of one point of the network.
Dense denseClustered(const Network& network, int point) {
  const MatrixXd& J = network.J;
  const MatrixXd inverse = (J.transpose() * J).inverse(), H = J * inverse * J.transpose();
  const VectorXd residuals = network.est.residuals();
  // Residuals come pool after pool, the star first; both have two rows for each measurement.
  MatrixXd R(J.rows(), 2);
  for (Index m = 0; m < J.rows(); ++m) R.row(m) = residuals.segment<2>(2 * m).transpose();
  const int groups = network.group.back() + 1;
  Dense result;
  double stated = 0;
  MatrixXd P(J.rows(), groups);
  Index first = 0;
  for (int g = 0; g < groups; ++g) {
    Index size = 0;
    while (first + size < J.rows() && network.group[static_cast<std::size_t>(first + size)] == g) ++size;
    const MatrixXd Q = MatrixXd::Identity(size, size) - H.block(first, first, size, size);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(Q);
    VectorXd root(size);
    for (Index k = 0; k < size; ++k) {  // a measurement that alone determines a point is taken as stated
      const double left = eigen.eigenvalues()[k];
      root[k] = left > 1e-8 ? 1 / std::sqrt(left) : 0;
      const double alone = eigen.eigenvectors().col(k).dot(J.middleRows(first, size) * inverse.col(point));
      if (!(left > 1e-8)) stated += alone * alone;
    }
    const MatrixXd A = eigen.eigenvectors() * root.asDiagonal() * eigen.eigenvectors().transpose();
    const VectorXd x = A * J.middleRows(first, size) * inverse.col(point);
    const Eigen::Vector2d effect = R.middleRows(first, size).transpose() * x;
    result.C += effect * effect.transpose();
    P.col(g) = -H.middleCols(first, size) * x;
    P.col(g).segment(first, size) += x;
    first += size;
  }
  const MatrixXd B = P.transpose() * P;
  result.C += stated * Eigen::Matrix2d::Identity();
  result.dof = (B.trace() + stated) * (B.trace() + stated) / B.squaredNorm();
  return result;
}

TEST(ClusteredLarge, LeveragesFromSelectedInversion) {
  Network network(60, 250, 1);
  const slom::Clustered c = slom::clustered(network.est);
  for (const int point : {0, 17, 59}) {
    const auto& id = network.points[static_cast<std::size_t>(point)];
    const Dense dense = denseClustered(network, point);
    EXPECT_LT((c.covariance(id) - dense.C).norm(), 1e-9 * dense.C.norm());
    EXPECT_NEAR(c.degreesOfFreedom(id)[0], dense.dof, 1e-8 * dense.dof);
  }
  EXPECT_TRUE(c.notes().empty());
}

TEST(ClusteredLarge, LeveragesFromColumnsOfTheInverse) {
  Network network(60, 300, 3);
  const slom::Clustered c = slom::clustered(network.est);
  const auto& id = network.points[7];
  const Dense dense = denseClustered(network, 7);
  EXPECT_LT((c.covariance(id) - dense.C).norm(), 1e-9 * dense.C.norm());
  EXPECT_NEAR(c.degreesOfFreedom(id)[1], dense.dof, 1e-8 * dense.dof);
}

TEST(ClusteredLarge, DegreesOfFreedomFromRandomSigns) {
  Network network(170, 700, 1);  // 340 unknowns, 700 groups
  const slom::Clustered c = slom::clustered(network.est);
  SLOM_SKIP_WITH_SANITIZERS();  // the dense matrices below
  for (const int point : {3, 100}) {
    const Dense dense = denseClustered(network, point);
    EXPECT_NEAR(c.degreesOfFreedom(network.points[static_cast<std::size_t>(point)])[0], dense.dof,
                0.03 * dense.dof);
  }
}

TEST(ClusteredLarge, WithoutLeverages) {
  Network network(60, 300, 3);
  const slom::Clustered few = slom::clustered(network.est, {.most_columns = 1});
  const slom::Clustered c =
      slom::clustered(network.est, {.correction = ClusterCorrection::cr1, .most_columns = 1});
  const slom::Clustered all = slom::clustered(network.est, {.correction = ClusterCorrection::cr1});
  const auto& id = network.points[7];
  EXPECT_LT((few.covariance(id) - all.covariance(id)).norm(), 1e-9 * all.covariance(id).norm());
  EXPECT_LT((c.covariance(id) - all.covariance(id)).norm(), 1e-9 * all.covariance(id).norm());
  const std::vector<std::string> notes = few.notes();
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(
      notes[0],
      "the leverage of 100 groups takes too many columns of H^-1 (ClusterOptions::most_columns); their residuals are "
      "corrected as by cr1");
  EXPECT_TRUE(std::isnan(few.change(id)(3, 0)));
  EXPECT_EQ(few.check()[3].dof, 0);
}

/// A line, measured along a walk: group i has a step to the next place and measurements at its place, with three levels of
/// its own. Errors of successive groups are alike.
struct Walk {
  slom::Estimator est;
  slom::VarID<vec2> line = est.insertRV(vec2(0, 0), "line");
  std::vector<slom::VarID<double>> places;

  Walk(unsigned seed, int groups) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i <= groups; ++i) places.push_back(est.insertRV(0.0));
    double common = 0;
    const auto see = [](const auto& l, const auto& place, const auto& level, double t) {
      return l[0] + l[1] * t + place + level;
    };
    const auto measured = [&] { return slom::measured(common + normal(engine)); };
    for (int i = 0; i < groups; ++i) {
      const slom::Group group = slom::group("image", i);
      const auto& place = places[static_cast<std::size_t>(i)];
      common = 0.7 * common + normal(engine);
      est.insertMeasurement(difference, place, places[static_cast<std::size_t>(i) + 1], measured(), group);
      est.insertMeasurement(is, place, measured(), group);
      for (int k = 0; k < 3; ++k) {
        const auto level = est.insertRV(0.0);
        est.insertMeasurement(is, level, measured(), group);
        for (int m = 0; m < 2; ++m)
          est.insertMeasurement(see, line, place, level, normal(engine), measured(), group);
      }
    }
    est.insertMeasurement(is, places.back(), slom::measured(0.));  // in no group
    EXPECT_TRUE(est.optimize({.most_parameters = 0}).converged);
  }
};

/// The inverse of shared unknowns and groups joined from others give what columns of the inverse and explicit blocks give.
TEST(ClusteredLarge, JoinedGroupsAreBlocks) {
  const unsigned seed = slom::testing::freshSeed();
  Walk walk(seed, 128), by_columns(seed, 128);
  by_columns.est.setFreeGauge(slom::FreeGauge::inner_constraints);
  const slom::ClusterOptions in_order{.correction = ClusterCorrection::cr2, .ordered = true};
  const slom::Clustered c = slom::clustered(walk.est, in_order),
                        reference = slom::clustered(by_columns.est, in_order);
  const int length = c.blockLength(walk.line);
  ASSERT_EQ(reference.blockLength(by_columns.line), length) << seed;
  const MatrixXd C = c.covariance(walk.line);
  EXPECT_LT((reference.covariance(by_columns.line) - C).norm(), 1e-9 * C.norm()) << seed;
  const VectorXd dof = c.degreesOfFreedom(walk.line);
  EXPECT_LT((reference.degreesOfFreedom(by_columns.line) - dof).norm(), 1e-6 * dof.norm()) << seed;
  const auto byBlocks = [&](int blocks) {
    return slom::clustered(walk.est, {.by = {slom::ClusterBy::blocks("image", blocks)},
                                      .correction = ClusterCorrection::cr2})
        .standardDeviation(walk.line)
        .cwiseAbs2()
        .eval();
  };
  if (length == 1 || !c.notes(walk.line).empty()) return;  // the variance still grows
  const VectorXd now = byBlocks(length), expected = now.cwiseMax(2 * now - byBlocks(length / 2));
  EXPECT_LT((C.diagonal() - expected).norm(), 1e-9 * expected.norm()) << seed;
}

/// Huber's formula for a location: sum psi^2 / (sum psi')^2.
TEST(ClusteredLarge, WithLosses) {
  for (const bool is_redescending : {false, true}) {
    slom::Estimator est;
    const auto level = est.insertRV(0.0, "level");
    std::mt19937 engine(6);
    std::normal_distribution<double> normal;
    const slom::Loss loss = is_redescending ? slom::Loss(slom::Tukey(4.685)) : slom::Loss(slom::Huber(1));
    std::vector<double> data;
    for (int i = 0; i < 60; ++i) {
      data.push_back(normal(engine) + (i % 10 == 0 ? 4 : 0));
      est.insertMeasurement(is, level, slom::measured(data.back()), loss, slom::group(i));
    }
    ASSERT_TRUE(est.optimize().converged);
    double squares = 0, slopes = 0;
    for (const double y : data) {
      const double r = *level - y;
      const slom::LossValue value = loss.evaluate(r * r);
      squares += value.first * value.first * r * r;
      slopes += value.first + 2 * value.second * r * r;
    }
    const double dense = squares / (slopes * slopes);
    const slom::Clustered c = slom::clustered(est, {.correction = ClusterCorrection::cr0});
    EXPECT_NEAR(c.covariance(level)(0, 0), dense, 1e-6 * dense);
  }
}

/// Counts the columns that are solved for.
class CountingSolver final : public slom::ForwardingSolver {
 public:
  explicit CountingSolver(int& columns)
      : ForwardingSolver(std::make_unique<slom::BlockSolver>()), columns_(columns) {}
  slom::SolveStatus solveFor(const MatrixXd& B, MatrixXd& X) override {
    columns_ += static_cast<int>(B.cols());
    return ForwardingSolver::solveFor(B, X);
  }

 private:
  int& columns_;
};

/// Returns the number of columns solved for covariance and degrees of freedom of a line. `groups` sets measure the
/// line, each with a level of its own.
int columnsFor(int groups) {
  int columns = 0;
  slom::Estimator est;
  est.changeSolver(std::make_unique<CountingSolver>(columns));
  const auto line = est.insertRV(vec2(0, 0));
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  for (int g = 0; g < groups; ++g) {
    const auto level = est.insertRV(0.0);
    for (int i = 0; i < 4; ++i) {
      const double x = normal(engine), t = normal(engine);
      est.insertMeasurement(
          [](const auto& l, const auto& h, double a, double b) { return l[0] * a + l[1] * b + h; }, line,
          level, x, t, slom::measured(normal(engine)), slom::group(g));
    }
  }
  EXPECT_TRUE(est.optimize({.most_parameters = 0}).converged);
  const int before = columns;
  const slom::Clustered c = slom::clustered(est);
  EXPECT_GT(c.standardDeviation(line)[0], 0);
  EXPECT_GT(c.degreesOfFreedom(line)[0], groups / 4);
  EXPECT_EQ(c.influence(line).rows(), groups);
  return columns - before;
}

TEST(ClusteredLarge, SolvesDoNotGrowWithTheGroups) {
  const int few = columnsFor(50);
  EXPECT_LE(few, 10);
  EXPECT_EQ(columnsFor(2000), few);
}

/// Laps of a robot whose heading drifts differently in each lap. The clustered covariance is that of the simulation.
TEST(ClusteredLarge, PoseGraphWhoseLapsShareErrors) {
  SLOM_SKIP_WITH_SANITIZERS();
  constexpr int laps = 24, per_lap = 6, repetitions = 300;
  std::mt19937 engine(8);
  std::normal_distribution<double> normal;
  Eigen::Vector3d squares = Eigen::Vector3d::Zero(), clustered = squares, stated = squares, holds = squares;
  std::vector<SE2> truth(per_lap);
  for (int k = 1; k < per_lap; ++k) {
    const double angle = 2 * 3.141592653589793 * k / per_lap;
    truth[static_cast<std::size_t>(k)] = SE2(vec2(5 * std::sin(angle), 5 - 5 * std::cos(angle)));
    truth[static_cast<std::size_t>(k)].orient = mtk::SO2<>(angle);
  }
  const Eigen::Vector3d sigma(0.02, 0.02, 0.01);
  for (int n = 0; n < repetitions; ++n) {
    slom::Estimator est;
    est.setThreads(1);
    std::vector<slom::VarID<SE2>> poses;
    for (std::size_t k = 0; k < per_lap; ++k) poses.push_back(est.insertRV(truth[k], k > 0));
    for (int lap = 0; lap < laps; ++lap) {
      const Eigen::Vector3d shared(0.02 * normal(engine), 0.02 * normal(engine), 0.01 * normal(engine));
      for (std::size_t k = 0; k < per_lap; ++k) {
        const std::size_t next = (k + 1) % per_lap;
        SE2 z = truth[k].inverse() * truth[next];
        Eigen::Vector3d error;
        for (int i = 0; i < 3; ++i) error[i] = shared[i] + sigma[i] * normal(engine);
        mtk::boxplus<SE2>(z, error);
        est.insertMeasurement(slom::RelativePose(), poses[k], poses[next], slom::measured(z),
                              slom::StandardDeviation(sigma), slom::group("lap", lap));
      }
    }
    ASSERT_TRUE(est.optimize({.most_parameters = 0}).converged);
    const slom::Clustered c = slom::clustered(est);
    Eigen::Vector3d error;
    mtk::boxminus(mtk::vectview<double, 3>(error.data()), *poses[3], truth[3]);
    const Eigen::Vector3d half = c.interval(poses[3]);
    for (int i = 0; i < 3; ++i) {
      squares[i] += error[i] * error[i] / repetitions;
      holds[i] += std::abs(error[i]) <= half[i] ? 1.0 / repetitions : 0;
    }
    clustered += c.covariance(poses[3]).diagonal() / repetitions;
    stated += est.covariance(poses[3]).diagonal() / repetitions;
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(clustered[i] / squares[i], 1, 0.25) << i;
    EXPECT_GE(holds[i], 0.92) << i;
    EXPECT_LE(holds[i], 0.98) << i;
  }
  EXPECT_GT((squares.cwiseQuotient(stated)).maxCoeff(), 1.4);
}

}  // namespace
