// Whole fits with traced functions end where those without do.
#include <random>

#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/tape.hpp>

#include "measurements/kind.hpp"

namespace slom::testing {
namespace {

/// Fits the problem that `build(estimator, wrap)` makes, with functions as they are and traced; compares the RSS.
template <class Build>
void expectTheSameFit(const Build& build) {
  Estimator plain, by_tape;
  build(plain, [](auto f) { return f; });
  build(by_tape, [](auto f) { return traced(f); });
  const Summary one = plain.optimize(), other = by_tape.optimize();
  EXPECT_TRUE(one.converged);
  EXPECT_TRUE(other.converged);
  EXPECT_NEAR(other.initial_rss, one.initial_rss, 1e-12 * one.initial_rss);
  EXPECT_NEAR(other.final_rss, one.final_rss, 1e-12 * std::max(1.0, one.final_rss));
  Estimator copy = by_tape.clone();
  EXPECT_NEAR(copy.optimize().final_rss, one.final_rss, 1e-12 * std::max(1.0, one.final_rss));
}

TEST(TracedFits, Circle) {
  expectTheSameFit([](Estimator& est, const auto& wrap) {
    const auto centre = est.insertRV(Vec2(0.1, 0), "centre");
    const auto radius = est.insertRV(1.0, "radius");
    Random random(1);
    for (int i = 0; i < 100; ++i) {
      const Vec2 p(2 + 3 * std::cos(i) + random.number(-0.1, 0.1),
                   1 + 3 * std::sin(i) + random.number(-0.1, 0.1));
      const auto f = [](const auto& c, const auto& r, const auto& q) { return (q - c).norm() - r; };
      if (i % 3 == 0) {
        est.insertMeasurement(wrap(f), centre, radius, p, StandardDeviation(0.1), Huber(1.5));
      } else {
        est.insertMeasurement(wrap(f), centre, radius, p, StandardDeviation(0.1 + 0.001 * i));
      }
    }
  });
}

template <class T>
void buildGraph(Estimator& est, const auto& wrap, const Eigen::MatrixXd& covariance) {
  Random random(2);
  std::vector<T> truth{T()};
  std::vector<VarID<T>> poses{est.insertRV(T(), false)};
  const auto noisy = [&](const T& x, double size) {
    mtk::tangent_t<T> d;
    for (double& own : d) own = random.number(-size, size);
    return mtk::moved(x, mtk::vectview<const double, T::DOF>(d));
  };
  for (int i = 1; i < 40; ++i) {
    truth.push_back(truth.back() * noisy(T(), 1.0));
    poses.push_back(est.insertRV(noisy(truth.back(), 0.05)));
    for (int k = 1; k <= std::min(3, i); ++k) {
      const auto from = static_cast<std::size_t>(i - k), to = static_cast<std::size_t>(i);
      est.insertMeasurement(wrap(RelativePose()), poses[from], poses[to],
                            measured(noisy(truth[from].inverse() * truth[to], 0.02)), Covariance(covariance));
    }
  }
}
TEST(TracedFits, PoseGraphs) {
  expectTheSameFit([](Estimator& est, const auto& wrap) {
    buildGraph<SE2>(est, wrap, Eigen::Vector3d(1e-4, 2e-4, 3e-4).asDiagonal());
  });
  expectTheSameFit([](Estimator& est, const auto& wrap) {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(6, 6) * 1e-4;
    covariance(0, 1) = covariance(1, 0) = 2e-5;
    buildGraph<SE3>(est, wrap, covariance);
  });
}

TEST(TracedFits, Bundle) {
  expectTheSameFit([](Estimator& est, const auto& wrap) {
    Random random(3);
    std::vector<Vec3> points;
    std::vector<VarID<Vec3>> landmarks;
    for (int i = 0; i < 30; ++i) {
      points.push_back(random.vector<Vec3>(2));
      landmarks.push_back(est.insertRV(Vec3(points.back() + random.vector<Vec3>(0.02))));
      est.prior(landmarks.back(), points.back(), 0.1);
    }
    for (int c = 0; c < 4; ++c) {
      SnavelyCamera camera;
      camera.pose = SE3(SO3::exp(random.vector<Vec3>(0.2)), Vec3(random.number(), random.number(), -8));
      camera.intrinsics = SnavelyIntrinsics<>(500, -0.1, 0.01);
      const auto id = est.insertRV(camera);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2 pixel = Reprojection()(camera, points[i]);
        est.insertMeasurement(wrap(Reprojection()), id, landmarks[i],
                              measured(Vec2(pixel + random.vector<Vec2>(0.5))), StandardDeviation(0.5));
      }
    }
  });
}

TEST(TracedFits, MeasurementsCanBeRemovedAndInserted) {
  Estimator est;
  const auto x = est.insertRV(0.0, "x");
  std::vector<AnyMeasID> all;
  for (int i = 0; i < 100; ++i) {
    all.push_back(est.insertMeasurement(traced([](const auto& own, const auto& z) { return own - z; }), x,
                                        static_cast<double>(i), named("reading"), group(i % 4)));
  }
  for (std::size_t i = 0; i < 50; ++i) est.removeMeasurement(all[i]);
  EXPECT_EQ(est.nameOf(all[60]), "reading #61");
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*x, 74.5, 1e-12);
}

}  // namespace
}  // namespace slom::testing
