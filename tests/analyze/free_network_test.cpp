// Free networks: by every algorithm the values are those nearest to the start, and the covariances the pseudo-inverse.
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/algorithms.hpp"
#include "support/message_of.hpp"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using slom::testing::allAlgorithms;
using slom::testing::messageOf;

/// A network of numbers per point, its start values and the noise-free measurements between pairs of points.
template <class Point>
struct FreePoints {
  using Difference = std::function<void(slom::Estimator&, const slom::VarID<Point>&,
                                        const slom::VarID<Point>&, const Point&, const Point&, double noise)>;
  slom::Estimator est;
  std::vector<slom::VarID<Point>> ids;
  std::vector<Point> start;

  FreePoints(unsigned seed, int points, const std::function<Point(std::mt19937&)>& draw,
             const std::function<Point(std::mt19937&)>& error, const Difference& insert) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0, 0.01);
    std::vector<Point> truth;
    for (int i = 0; i < points; ++i) {
      truth.push_back(draw(engine));
      start.push_back(truth.back() + error(engine));
      ids.push_back(est.insertRV(start.back(), "p" + std::to_string(i)));
    }
    for (int i = 0; i < points; ++i) {
      for (int j = 0; j < i; ++j)
        insert(est, ids[at(i)], ids[at(j)], truth[at(i)], truth[at(j)], noise(engine));
    }
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static VectorXd numbersOf(const Point& p) {
    if constexpr (std::is_same_v<Point, double>) {
      return VectorXd::Constant(1, p);
    } else {
      return p;
    }
  }
  VectorXd moved() const {
    VectorXd all(0);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const VectorXd d = numbersOf(*est.own(ids[i])) - numbersOf(start[i]);
      VectorXd more(all.size() + d.size());
      more << all, d;
      all = more;
    }
    return all;
  }
  /// Whitened, by central differences.
  MatrixXd jacobian() {
    const VectorXd r = est.residuals();
    const int dof = static_cast<int>(numbersOf(start[0]).size()), n = dof * static_cast<int>(ids.size());
    MatrixXd J(r.size(), n);
    for (int k = 0; k < n; ++k) {
      const auto& id = ids[at(k / dof)];
      const Point x = *est.own(id);
      const auto residualsAt = [&](double h) {
        Point y = x;
        if constexpr (std::is_same_v<Point, double>) {
          y += h;
        } else {
          y[k % dof] += h;
        }
        est.reinitRV(id, y);
        const VectorXd result = est.residuals();
        est.reinitRV(id, x);
        return result;
      };
      J.col(k) = (residualsAt(1e-3) - residualsAt(-1e-3)) / 2e-3;
    }
    return J;
  }
};

/// `free`: the number of free directions.
template <class Point>
void expectFreeNetwork(const std::function<FreePoints<Point>()>& make, int free) {
  VectorXd values;
  for (const auto& algorithm : allAlgorithms()) {
    FreePoints<Point> network = make();
    slom::Estimator& est = network.est;
    est.changeAlgorithm(algorithm->clone().release());
    est.setFreeGauge(slom::FreeGauge::inner_constraints);
    const slom::Summary summary = est.optimize();
    ASSERT_TRUE(summary.converged) << summary;
    EXPECT_TRUE(summary.is_free_network);
    EXPECT_EQ(summary.free_directions, free) << summary;
    EXPECT_EQ(summary.redundancy, est.getM() - est.getN() + free);
    // The oracle: a dense singular value decomposition.
    const MatrixXd J = network.jacobian();
    const Eigen::JacobiSVD<MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeFullV);
    const MatrixXd N = svd.matrixV().rightCols(free), V = svd.matrixV().leftCols(J.cols() - free);
    const VectorXd moved = network.moved();
    EXPECT_LT((N.transpose() * moved).norm(), 1e-6 * (1 + moved.norm())) << algorithm->name();
    const VectorXd inverse = svd.singularValues().head(J.cols() - free).cwiseInverse().cwiseAbs2();
    const MatrixXd C = V * inverse.asDiagonal() * V.transpose();
    const int dof = static_cast<int>(moved.size() / static_cast<Eigen::Index>(network.ids.size()));
    for (std::size_t i = 0; i < network.ids.size(); ++i) {
      const MatrixXd own =
          C.block(static_cast<Eigen::Index>(i) * dof, static_cast<Eigen::Index>(i) * dof, dof, dof);
      EXPECT_LT((est.covariance(network.ids[i]) - own).norm(), 1e-5 * own.norm()) << algorithm->name();
    }
    // Every algorithm ends at the same values, and none is held at its start.
    if (values.size() == 0) values = moved;
    EXPECT_LT((moved - values).norm(), 1e-6 * values.norm()) << algorithm->name();
    EXPECT_GT(moved.cwiseAbs().minCoeff(), 0);
    EXPECT_EQ(slom::outliers(est).unconverged, "");
  }
}

double uniformIn(std::mt19937& engine, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(engine);
}

TEST(FreeNetwork, OfHeightsFromDifferences) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    expectFreeNetwork<double>(
        [&] {
          return FreePoints<double>(
              seed, 6, [](auto& engine) { return uniformIn(engine, 90, 110); },
              [](auto& engine) { return uniformIn(engine, -2, 2); },
              [](auto& est, const auto& a, const auto& b, double x, double y, double noise) {
                est.insertMeasurement([](const auto& p, const auto& q) { return q - p; }, a, b,
                                      slom::measured(y - x + noise), slom::StandardDeviation(0.01));
              });
        },
        1);
  }
}

template <int Dim>
FreePoints<mtk::vect<Dim>> distanceNetwork(unsigned seed, double error) {
  using Point = mtk::vect<Dim>;
  const auto within = [](double size) {
    return [size](std::mt19937& engine) {
      Point p;
      for (int i = 0; i < Dim; ++i) p[i] = uniformIn(engine, -size, size);
      return p;
    };
  };
  return FreePoints<Point>(
      seed, 7, within(100), within(error),
      [](auto& est, const auto& a, const auto& b, const Point& x, const Point& y, double noise) {
        est.insertMeasurement([](const auto& p, const auto& q) { return (q - p).norm(); }, a, b,
                              slom::measured((y - x).norm() + noise), slom::StandardDeviation(0.01));
      });
}

TEST(FreeNetwork, OfDistances) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    expectFreeNetwork<mtk::vect<2>>([&] { return distanceNetwork<2>(seed, 5); }, 3);
    expectFreeNetwork<mtk::vect<3>>([&] { return distanceNetwork<3>(seed, 5); }, 6);
  }
}

TEST(FreeNetwork, IsThatOfAllVariablesAlsoFarFromTheStart) {
  // Start values that are turned by half a radian: the gauge itself has to be moved back a long way.
  slom::Estimator est;
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  using Point = mtk::vect<2>;
  std::mt19937 engine(7);
  std::vector<slom::VarID<Point>> ids;
  std::vector<Point> truth, start;
  for (int i = 0; i < 8; ++i) {
    truth.push_back(Point(uniformIn(engine, -50, 50), uniformIn(engine, -50, 50)));
    start.push_back(Eigen::Rotation2Dd(0.5) * truth.back() +
                    Point(uniformIn(engine, -9, 9), uniformIn(engine, -9, 9)));
    ids.push_back(est.insertRV(start.back()));
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      est.insertMeasurement([](const auto& p, const auto& q) { return (q - p).norm(); }, ids[i], ids[j],
                            slom::measured((truth[j] - truth[i]).norm()), slom::StandardDeviation(0.01));
    }
  }
  ASSERT_TRUE(est.optimize().converged);
  // The best fit of the truth onto the start values, by the closed formula for rotations in the plane.
  Point mean_truth(0, 0), mean_start(0, 0);
  for (std::size_t i = 0; i < ids.size(); ++i) mean_truth += truth[i] / 8.0, mean_start += start[i] / 8.0;
  double dot = 0, cross = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Eigen::Vector2d a = truth[i] - mean_truth, b = start[i] - mean_start;
    dot += a.dot(b);
    cross += a[0] * b[1] - a[1] * b[0];
  }
  const Eigen::Rotation2Dd turn(std::atan2(cross, dot));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Eigen::Vector2d expected = turn * (truth[i] - mean_truth) + Eigen::Vector2d(mean_start);
    EXPECT_LT((*ids[i] - expected).norm(), 1e-6) << i;
  }
}

TEST(FreeNetwork, IsAnOrdinaryFitWhereNothingIsFreeOrMoreThanTheGauge) {
  FreePoints<double> network(
      3, 4, [](auto& engine) { return uniformIn(engine, 90, 110); },
      [](auto& engine) { return uniformIn(engine, -2, 2); },
      [](auto& est, const auto& a, const auto& b, double x, double y, double noise) {
        est.insertMeasurement([](const auto& p, const auto& q) { return q - p; }, a, b,
                              slom::measured(y - x + noise), slom::StandardDeviation(0.01));
      });
  EXPECT_EQ(messageOf([&] { (void)network.est.covariance(network.ids[0]); }).substr(0, 17),
            "[slom.free-gauge]");
  network.est.setFreeGauge(slom::FreeGauge::inner_constraints);
  network.est.fix(network.ids[2]);
  const slom::Summary fixed = network.est.optimize();
  EXPECT_TRUE(fixed.converged);
  EXPECT_FALSE(fixed.is_free_network);
  EXPECT_EQ(*network.ids[2], network.start[2]);
  network.est.free(network.ids[2]);
  const auto alone = network.est.insertRV(1.0, "alone"), other = network.est.insertRV(2.0, "other");
  network.est.insertMeasurement([](const auto& a, const auto& b) { return a * b - 3.0; }, alone, other);
  const slom::Summary more = network.est.optimize();
  EXPECT_EQ(more.stop_reason, slom::StopReason::rank_deficient) << more;
}

}  // namespace
