// Consistency: the normalised estimation error squared (NEES) of simulated runs against chi-square; the inconsistency of
// the extended filter in SLAM, and its mending by the invariant error.
#include <numbers>

#include <gtest/gtest.h>

#include <slom/analyze/chi_square.hpp>
#include <slom/filter.hpp>
#include <slom/filter/invariant.hpp>

#include "random_matrices.hpp"

namespace slom::testing {

using SO3 = mtk::SO3<>;
using Vec3 = mtk::vect<3>;

/// Attitude and bias of a gyroscope, with two directions seen.
template <class S>
struct GyroOf {
  mtk::SO3<S> orient;
  mtk::vect<3, S> bias;
};
using Gyro = GyroOf<double>;

struct Turn {
  auto operator()(const auto& x, const Vec3& gyro, double dt) const {
    auto y = x;
    using S = mtk::scalar_t<decltype(y)>;
    y.orient = x.orient * mtk::SO3<S>::exp(mtk::vect<3, S>((gyro - x.bias) * dt));
    return y;
  }
};
constexpr auto direction = [](const auto& x, const Vec3& world) { return x.orient.inverse() * world; };

/// Returns the mean NEES of `runs` runs after each of 20 steps.
template <class MakeFilter>
std::vector<double> meanNees(const MakeFilter& make, int runs, unsigned seed) {
  RandomMatrices random(seed);
  std::vector<double> mean(20);
  const double dt = 0.1, turn_noise = 0.01, walk = 0.002, sigma = 0.05;
  for (int run = 0; run < runs; ++run) {
    Gyro truth{SO3::exp(random.vector<3>()), random.vector<3>(0.05)};
    mtk::vect<6> start;
    start << random.matrix<3, 1>() * 0.2, random.matrix<3, 1>() * 0.02;
    // x_true = x0 [+] e: the start that has the truth at e.
    Gyro x0{truth.orient * SO3::exp(Vec3(start.head<3>())).inverse(), Vec3(truth.bias - start.tail<3>())};
    mtk::vect<6> deviations;
    deviations << 0.2, 0.2, 0.2, 0.02, 0.02, 0.02;
    auto filter = make(x0, StandardDeviation(deviations));
    for (double& sum : mean) {
      const Vec3 rate = random.vector<3>(0.5);
      const Vec3 gyro(rate + truth.bias);
      mtk::vect<6> noise;
      noise << turn_noise, turn_noise, turn_noise, walk, walk, walk;
      truth = Turn()(truth, gyro, dt);
      truth.orient = truth.orient * SO3::exp(random.vector<3>(turn_noise));
      truth.bias += random.vector<3>(walk);
      EXPECT_TRUE(filter.predict(Turn(), StandardDeviation(noise), gyro, dt));
      for (const Vec3& world : {Vec3(0, 0, 1), Vec3(1, 0.5, 0)}) {
        const Vec3 seen(direction(truth, world) + random.vector<3>(sigma));
        EXPECT_TRUE(filter.update(direction, world, measured(seen), StandardDeviation(sigma)));
      }
      sum += filter.nees(truth) / runs;
    }
  }
  return mean;
}

/// Expects the mean NEES of most steps within the 95 % band of chi-square, and of all steps within that of 99.99 %.
void expectConsistent(const std::vector<double>& nees, int runs, int dof) {
  const auto bound = [&](double p) { return chiSquareCritical(p, double(runs * dof)) / runs; };
  int inside = 0;
  for (std::size_t k = 0; k < nees.size(); ++k) {
    EXPECT_GT(nees[k], bound(1 - 5e-5)) << k;
    EXPECT_LT(nees[k], bound(5e-5)) << k;
    inside += nees[k] > bound(0.975) && nees[k] < bound(0.025);
  }
  EXPECT_GE(inside, int(0.8 * double(nees.size())));
}

TEST(Consistency, NeesOf500RunsIsInItsBand) {
  const int runs = 500;
  expectConsistent(meanNees([](const Gyro& x, const auto& n) { return ErrorStateFilter(x, n); }, runs, 1),
                   runs, 6);
  expectConsistent(
      meanNees([](const Gyro& x, const auto& n) { return ErrorStateFilter(x, n, square_root); }, runs, 2),
      runs, 6);
  expectConsistent(meanNees([](const Gyro& x, const auto& n) { return UnscentedFilter(x, n); }, runs, 3),
                   runs, 6);
  expectConsistent(
      meanNees([](const Gyro& x, const auto& n) { return UnscentedFilter(x, n, square_root); }, runs, 4),
      runs, 6);
}

/// A covariance that stays in the tangent space of the old mean.
template <class S, int N>
struct NotCarried : FullCovariance<S, N> {
  template <int K>
  void transform(int, const detail::SquareMatrix<S, K>&) {}
};
/// Returns the NEES for each number of an attitude with a deviation of 0.3 rad at the start, after 20 sights of `seen`
/// directions.
template <template <class, int> class Form>
double attitudeNees(int seen) {
  RandomMatrices random(3);
  const double start = 0.3, sigma = 0.05;
  double mean = 0;
  const int runs = 3000;
  for (int run = 0; run < runs; ++run) {
    const SO3 truth = SO3::exp(random.vector<3>());
    const Vec3 e(random.vector<3>(start));
    ErrorStateFilter<SO3, Form> filter(truth * SO3::exp(e).inverse(), StandardDeviation(start));
    const auto look = [](const auto& x, const Vec3& world) { return x.inverse() * world; };
    for (int k = 0; k < 20; ++k) {
      for (int i = 0; i < seen; ++i) {
        const Vec3 world(i, 0, 1 - i);
        const Vec3 reading(look(truth, world) + random.vector<3>(sigma));
        EXPECT_TRUE(filter.update(look, world, measured(reading), StandardDeviation(sigma)));
      }
    }
    mean += filter.nees(truth) / (3 * runs);
  }
  return mean;
}

TEST(Consistency, IsBetterWhereTheCovarianceIsCarried) {
  const double one = attitudeNees<FullCovariance>(1), two = attitudeNees<FullCovariance>(2);
  std::printf("NEES: one direction %.2f, %.2f not carried; two directions %.2f, %.2f not carried\n", one,
              attitudeNees<NotCarried>(1), two, attitudeNees<NotCarried>(2));
  EXPECT_LT(one, 0.6 * attitudeNees<NotCarried>(1));
  EXPECT_LT(two, attitudeNees<NotCarried>(2));
  EXPECT_NEAR(two, 1, 0.08);
}

constexpr int kLandmarks = 10;
using SO2 = mtk::SO2<>;
using Vec2 = mtk::vect<2>;

/// A robot in the plane and landmarks, with errors of each part by itself.
template <class S>
struct MapOf {
  mtk::trafo<mtk::SO2<S>> pose;
  std::array<mtk::vect<2, S>, kLandmarks> landmarks;
  auto& orient() { return pose.orient; }
  const auto& orient() const { return pose.orient; }
  auto& place() { return pose.pos; }
  const auto& place() const { return pose.pos; }
  auto& landmark(std::size_t i) { return landmarks[i]; }
  const auto& landmark(std::size_t i) const { return landmarks[i]; }
};
/// The same as one element of a group: vectors[0] is the robot's place.
template <class S>
struct InvariantMapOf {
  RightInvariant<mtk::SO2<S>, 1 + kLandmarks> map;
  auto& orient() { return map.orient; }
  const auto& orient() const { return map.orient; }
  auto& place() { return map.vectors[0]; }
  const auto& place() const { return map.vectors[0]; }
  auto& landmark(std::size_t i) { return map.vectors[i + 1]; }
  const auto& landmark(std::size_t i) const { return map.vectors[i + 1]; }
};

struct Drive {
  auto operator()(const auto& x, const auto& w, double forward, double turn) const {
    auto y = x;
    using S = mtk::scalar_t<decltype(y)>;
    const mtk::vect<2, S> step(w[0] + forward, w[1]);
    y.place() = x.place() + x.orient() * step;
    y.orient() = mtk::SO2<S>(S(x.orient().angle() + w[2] + turn));
    return y;
  }
};
struct SeeLandmark {
  auto operator()(const auto& x, std::size_t i) const {
    return x.orient().inverse() * (x.landmark(i) - x.place());
  }
};

/// Returns the mean NEES of the heading at the end of runs in which a robot drives circles among landmarks. It sees those
/// within 5 m.
template <class Map>
double headingNees(int runs, unsigned seed) {
  RandomMatrices random(seed);
  constexpr int n = mtk::DOF_v<Map>;
  constexpr bool by_parts = std::is_same_v<Map, MapOf<double>>;
  const double forward = 0.3, radius = 6, sigma = 0.1;
  const Vec3 noise(0.05, 0.05, 0.02);
  double mean = 0;
  for (int run = 0; run < runs; ++run) {
    Map truth;
    for (std::size_t i = 0; i < kLandmarks; ++i) {
      const double angle = 2 * std::numbers::pi * double(i) / kLandmarks,
                   distance = radius * random.uniform(0.8, 1.4);
      truth.landmark(i) = Vec2(distance * std::cos(angle), radius + distance * std::sin(angle));
    }
    // The pose is known at the start. What is known of landmarks comes from observations.
    mtk::vect<n> start;
    for (int i = 0; i < n; ++i) start[i] = 1e-4;
    for (int i = 0; i < 2 * kLandmarks; ++i) start[(by_parts ? 3 : 2) + i] = 30;
    ErrorStateFilter filter(truth, StandardDeviation(start), square_root);
    for (int k = 0; k <= 400; ++k) {
      if (k > 0) {
        const Vec3 w(noise.cwiseProduct(random.matrix<3, 1>()));
        truth = Drive()(truth, w, forward, forward / radius);
        EXPECT_TRUE(
            filter.predict(Drive(), noiseArgument<3>(StandardDeviation(noise)), forward, forward / radius));
      }
      for (std::size_t i = 0; i < kLandmarks; ++i) {
        if (SeeLandmark()(truth, i).norm() > 5) continue;
        const Vec2 seen(SeeLandmark()(truth, i) + random.vector<2>(sigma));
        EXPECT_TRUE(filter.update(SeeLandmark(), i, measured(seen), StandardDeviation(sigma)));
      }
    }
    constexpr int heading = by_parts ? 2 : n - 1;
    const double e = mtk::difference(truth, filter.state())[heading];
    mean += e * e / filter.covariance()(heading, heading) / runs;
  }
  return mean;
}

TEST(Consistency, OfSlamNeedsTheInvariantError) {
  const int runs = 200;
  const double usual = headingNees<MapOf<double>>(runs, 7),
               invariant = headingNees<InvariantMapOf<double>>(runs, 7);
  std::printf("NEES of the heading: error by parts %.2f, right-invariant %.2f\n", usual, invariant);
  EXPECT_GT(usual, chiSquareCritical(0.005, runs) / runs);
  EXPECT_LT(invariant, chiSquareCritical(0.025, runs) / runs);
  EXPECT_GT(invariant, chiSquareCritical(0.975, runs) / runs);
}

}  // namespace slom::testing
