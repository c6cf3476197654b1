// Reports on a run: consistency of innovations, observability by name, adaptive noise.
#include <gtest/gtest.h>

#include <slom/filter.hpp>
#include <slom/filter/adaptive_noise.hpp>
#include <slom/filter/consistency.hpp>
#include <slom/filter/observability.hpp>

#include "random_matrices.hpp"

namespace slom::testing {

using Vec2 = mtk::vect<2>;

struct Track {
  double true_sigma = 0.5, stated_sigma = 0.5, offset = 0, stated_density = 0.1;
  double gate = 0;           ///< 0: none
  int outlier_every = 0;     ///< a measurement that is off by 20
  int lost_after = 1000000;  ///< steps, after which the target is 100 away
};
/// Tracks a target with a random velocity; returns the report of its positions.
InnovationReport<1> track(const Track& t, int steps = 2000) {
  RandomMatrices random(4);
  ErrorStateFilter filter(Vec2(0, 0), StandardDeviation(0.5));
  Vec2 x(random.vector<2>(0.5));
  InnovationReport<1> report;
  const auto move = [](const auto& y, double dt) {
    auto z = y;
    z[0] += y[1] * dt;
    return z;
  };
  const auto Q = [](double density, double dt) {
    return Eigen::Matrix2d(density *
                           (Eigen::Matrix2d() << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt).finished());
  };
  for (int k = 0; k < steps; ++k) {
    const double dt = 0.5;
    x = Vec2(move(x, dt) + random.sample<2>(Q(0.1, dt)));
    EXPECT_TRUE(filter.predict(move, SpectralDensity(Vec2(0, t.stated_density)), Duration(dt)));
    const double z = x[0] + t.offset + t.true_sigma * random.normal();
    const double jump =
        (t.outlier_every > 0 && k % t.outlier_every == 0 ? 20 : 0) + (k > t.lost_after ? 100 : 0);
    const auto seen = measured(z + jump);
    const auto first = [](const auto& y) { return y[0]; };
    report.add(t.gate > 0 ? filter.update(first, seen, StandardDeviation(t.stated_sigma), Gate(t.gate))
                          : filter.update(first, seen, StandardDeviation(t.stated_sigma)));
  }
  return report;
}

TEST(InnovationReport, SaysWhatToChange) {
  const auto ends = [](const InnovationReport<1>& report, const std::string& verdict) {
    const std::string text = report.sentence();
    EXPECT_EQ(text.substr(text.size() - std::min(text.size(), verdict.size())), verdict) << text;
  };
  ends(track({}), ": the filter is consistent");
  ends(
      track({.true_sigma = 0.5, .stated_sigma = 0.3}),
      ": innovations are larger than stated, and neighbours are opposite; state larger noise of the measurement, or use a "
      "gate or a loss");
  ends(
      track({.true_sigma = 0.5, .stated_sigma = 0.8}),
      ": innovations are smaller than stated, and neighbours are alike; state smaller noise of the measurement");
  ends(
      track({.true_sigma = 0.5, .stated_sigma = 0.5, .offset = 0, .stated_density = 1e-3}),
      ": innovations are larger than stated, and neighbours are alike; state larger noise of the motion, or estimate an error "
      "that lasts");
  // With a gate
  ends(track({.gate = 0.99}), ": the filter is consistent");
  ends(track({.gate = 0.999}), ": the filter is consistent");
  ends(
      track({.gate = 0.999, .outlier_every = 20}),
      ": the measurements that were used fit the stated noise, so those that were rejected are outliers; leave the noise as "
      "it is");
  const auto outliers = track({.gate = 0.99, .outlier_every = 20});
  EXPECT_NEAR(outliers.mean(), 1, 0.1);
  EXPECT_NE(outliers.sentence().find(" rejected by the gate where 20.0 are expected"), std::string::npos)
      << outliers.sentence();
  ends(
      track({.stated_sigma = 0.25, .gate = 0.999}),
      ": innovations are larger than stated, also those inside of the gate, and neighbours are opposite; state larger noise "
      "of the measurement");
  const std::string lost =
      ": most of the last measurements were rejected; the filter has lost the state or the sensor is disturbed: reset the filter, "
      "state larger noise of the motion, or widen the gate";
  ends(track({.gate = 0.999, .lost_after = 1980}), lost);
  ends(track({.gate = 0.999, .lost_after = -1}, 20), lost);
  const auto report = track({});
  EXPECT_GT(report.mean(), report.lower());
  EXPECT_LT(report.mean(), report.upper());
  EXPECT_NE(report.svg().find("2000 innovations of 1 numbers"), std::string::npos);
  const std::string few = "too few innovations for a report: 20 that are used are the least";
  EXPECT_EQ(InnovationReport<2>().sentence(), few);
  EXPECT_EQ(track({}, 19).sentence(), few);
  EXPECT_NE(track({}, 20).sentence(), few);
  EXPECT_LE(std::abs(track({}, 3).correlation()), 1);
}

/// Runs a random walk of the position (Order 1) or of the velocity (Order 2), with true noise 1 and stated noise; returns
/// the sentence of the report.
template <int Order>
std::string reportWith(double stated_R, double stated_Q, int seed) {
  using V = mtk::vect<Order>;
  RandomMatrices random(seed);
  V x, deviation;
  deviation[Order - 1] = 1;
  ErrorStateFilter filter(x, StandardDeviation(1));
  InnovationReport<1> report;
  const auto move = [](const auto& y) {
    auto z = y;
    if (Order == 2) z[0] += y[Order - 1];
    return z;
  };
  for (int k = 0; k < 2000; ++k) {
    x = move(x);
    x[Order - 1] += random.normal();
    EXPECT_TRUE(filter.predict(move, Covariance(V(stated_Q * deviation))));
    report.add(filter.update([](const auto& y, double z) { return y[0] - z; }, x[0] + random.normal(),
                             Covariance(stated_R)));
  }
  return report.sentence();
}
/// Returns what a sentence says on the noise of `part`: 1 larger, -1 smaller, 0 nothing.
int adviceOn(const std::string& part, const std::string& sentence) {
  const std::size_t state = sentence.find("; state ");
  if (state == std::string::npos) return 0;
  const std::size_t at = sentence.find("of the " + part, state);
  if (at == std::string::npos) return 0;
  const std::size_t larger = sentence.rfind("larger", at), smaller = sentence.rfind("smaller", at);
  const auto position = [&](std::size_t i) { return i == std::string::npos || i < state ? 0 : i; };
  return position(larger) > position(smaller) ? 1 : -1;
}
TEST(InnovationReport, AdvisesTowardsTheTruth) {
  EXPECT_EQ(
      adviceOn("motion", "x larger; state larger noise of the measurement and smaller noise of the motion"),
      -1);
  EXPECT_EQ(adviceOn("motion", "x; state larger noise of the measurement and of the motion"), 1);
  for (const int seed : {1, 2, 3, 4}) {
    for (const double R : {0.25, 1., 4.}) {
      for (const double Q : {0.25, 1., 4.}) {
        for (const std::string& text : {reportWith<1>(R, Q, seed), reportWith<2>(R, Q, seed)}) {
          const int toward_R = R > 1 ? -1 : R<1, toward_Q = Q> 1 ? -1 : Q < 1;
          const int on_R = adviceOn("measurement", text), on_Q = adviceOn("motion", text);
          if (R == 1 && Q == 1) continue;  // 1 in 20 is outside of the band
          EXPECT_GT(on_R * toward_R + on_Q * toward_Q, 0) << R << ' ' << Q << ' ' << text;
          EXPECT_TRUE(Q == 1 || R != 1 || on_Q == toward_Q) << Q << ' ' << text;
          EXPECT_TRUE(R == 1 || Q != 1 || on_R == toward_R) << R << ' ' << text;
        }
      }
    }
  }
}

TEST(NeesReport, HasTheBandOfChiSquare) {
  NeesReport report;
  EXPECT_EQ(report.sentence(), "no errors were added");
  for (int i = 0; i < 100; ++i) report.add(3, 3);
  EXPECT_NEAR(report.lower(), 0.846, 0.002);  // chi-square with 300 degrees of freedom
  EXPECT_NEAR(report.upper(), 1.166, 0.002);
  EXPECT_EQ(report.sentence(),
            "100 errors: NEES 1.00 for each number (95 % band 0.85 to 1.17): the covariance fits the errors");
  const auto endOf = [](double nees) {
    NeesReport r;
    for (int i = 0; i < 100; ++i) r.add(nees, 3);
    const std::string text = r.sentence();
    return text.substr(text.find("): ") + 3);
  };
  EXPECT_EQ(
      endOf(6),
      "errors are larger than the covariance says; state larger noise of the measurements or of the motion, or look "
      "for an error that lasts");
  EXPECT_EQ(
      endOf(1),
      "errors are smaller than the covariance says; state smaller noise of the measurements or of the motion");
  NeesReport few;
  few.add(3, 3);
  EXPECT_EQ(few.sentence(), "too few errors for a report: add those of more runs, for 20 numbers or more");
}

template <class S>
struct RobotOf {
  mtk::trafo<mtk::SO2<S>> pose;
  mtk::vect<2, S> beacon;
};

TEST(Observability, NamesWhatTheDataDoNotSee) {
#ifdef __clang__
  GTEST_SKIP() << "clang numbers the members of plain structs";
#endif
  RobotOf<double> start;
  start.beacon = Vec2(5, 0);
  ErrorStateFilter filter(start, StandardDeviation(1));
  const auto drive = [](const auto& x, double forward, double turn) {
    auto y = x;
    y.pose.pos = x.pose.pos + x.pose.orient * mtk::vect<2, mtk::scalar_t<decltype(y)>>(forward, 0.);
    y.pose.orient = x.pose.orient * mtk::SO2<>(turn);
    return y;
  };
  const auto see = [](const auto& x) { return x.pose.orient.inverse() * (x.beacon - x.pose.pos); };
  Observability map(filter, "robot");
  for (int k = 0; k < 20; ++k) {
    EXPECT_TRUE(map.predict(drive, Covariance(1e-12), 0.1, 0.2));
    EXPECT_TRUE(map.update(see, measured(see(map.filter().state())), StandardDeviation(0.1)));
  }
  EXPECT_EQ(map.unseen().size(), 3u);  // a map can move and turn as a whole

  Observability placed(filter, "robot");
  EXPECT_TRUE(
      placed.update([](const auto& x) { return x.pose.pos; }, measured(Vec2(0, 0)), StandardDeviation(0.1)));
  EXPECT_TRUE(placed.update([](const auto& x) { return x.beacon[0] + x.beacon[1]; }, measured(5.),
                            StandardDeviation(0.1)));
  EXPECT_EQ(
      placed.sentence(),
      "the data do not see 2 directions of the state: 1.00 robot.pose.orient.angle; 0.71 robot.beacon.x - 0.71 "
      "robot.beacon.y");
  EXPECT_TRUE(placed.update([](const auto& x) { return x.beacon[0]; }, measured(5.), StandardDeviation(0.1)));
  EXPECT_TRUE(placed.update([](const auto& x) { return x.pose.orient; }, measured(mtk::SO2<>(0)),
                            StandardDeviation(0.1)));
  EXPECT_EQ(placed.sentence().substr(0, 57), "the data see all directions of the state; the weakest has");
}

template <class S>
struct CarOf {
  mtk::vect<2, S> pos;
  mtk::SO2<S> heading;
  S speed;
};
/// Ranges to one beacon: a turn about it is not seen.
std::string rangesToOneBeacon(double sigma, int steps) {
  CarOf<double> start;
  start.pos = Vec2(3, 1);
  start.heading = mtk::SO2<>(0.2);
  start.speed = 1;
  Observability run(ErrorStateFilter(start, StandardDeviation(1)), "robot");
  RandomMatrices random(1);
  mtk::vect<4> density;
  density << 0, 0, 1e-4, 1e-2;
  const auto drive = [](const auto& x, double dt) {
    auto y = x;
    y.pos = x.pos + x.heading * mtk::vect<2, mtk::scalar_t<decltype(y)>>(x.speed * dt, x.speed * 0.);
    y.heading = x.heading * mtk::SO2<>(0.1 * dt);
    return y;
  };
  const auto range = [](const auto& x, double z) { return x.pos.norm() - z; };
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(run.predict(drive, SpectralDensity(density), Duration(0.1)));
    EXPECT_TRUE(
        run.update(range, run.filter().state().pos.norm() + sigma * random.normal(), StandardDeviation(0.1)));
  }
  return run.sentence();
}
TEST(Observability, DoubtsWhatMovingEstimatesSee) {
#ifdef __clang__
  GTEST_SKIP() << "clang numbers the members of plain structs";
#endif
  for (const int steps : {50, 500}) {
    const std::string noisy = rangesToOneBeacon(0.1, steps), exact = rangesToOneBeacon(0, steps);
    EXPECT_EQ(noisy.substr(0, 15), "the data hardly") << noisy;
    EXPECT_NE(noisy.find("try data without noise"), std::string::npos) << noisy;
    EXPECT_EQ(exact.substr(0, 15), "the data do not") << exact;
  }
}

TEST(Observability, TakesAnUnscentedFilter) {
  const auto move = [](const auto& x, double dt) {
    auto y = x;
    y[0] += x[1] * dt;
    return y;
  };
  const auto distance = [](const auto& x, double z) { return x[0] - z; };
  Observability run(UnscentedFilter(mtk::vect<3>(1, 2, 3), StandardDeviation(1)), "x");
  Observability by_derivatives(ErrorStateFilter(mtk::vect<3>(1, 2, 3), StandardDeviation(1)), "x");
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(run.predict(move, Covariance(1e-3), 0.1));
    ASSERT_TRUE(by_derivatives.predict(move, Covariance(1e-3), 0.1));
    ASSERT_TRUE(run.update(distance, 1., StandardDeviation(0.1)));
    ASSERT_TRUE(by_derivatives.update(distance, 1., StandardDeviation(0.1)));
  }
  EXPECT_EQ(run.sentence(), "the data do not see 1 direction of the state: 1.00 x.z");
  EXPECT_EQ(run.sentence(), by_derivatives.sentence());
  EXPECT_LT((run.filter().state() - by_derivatives.filter().state()).norm(), 1e-12);
  const auto before = run.filter().state();
  EXPECT_EQ(run.predict(move, Covariance(1), -0.1).status, FilterStatus::bad_duration);
  EXPECT_EQ(run.filter().state(), before);
}

TEST(AdaptiveNoise, LeavesABadStart) {
  for (const double start : {1e-3, 0.03, 0.1, 0.5, 1., 2., 10., 1e3}) {
    RandomMatrices random(3);
    double truth = 0;
    ErrorStateFilter filter(0.0, StandardDeviation(1));
    AdaptiveNoise<1> noise{StandardDeviation(start)};
    double sum = 0;
    for (int k = 0; k < 3000; ++k) {
      truth += random.normal();
      ASSERT_TRUE(filter.predict([](const auto& x) { return x; }, StandardDeviation(1)));
      ASSERT_TRUE(noise.update(
          filter, [](const auto& x, double z) { return x - z; }, truth + random.normal()));
      EXPECT_GT(noise.covariance()(0, 0), 0);
      if (k >= 2000) sum += noise.covariance()(0, 0) / 1000;
    }
    EXPECT_NEAR(sum, 1, 0.25) << start;
  }
}

template <class Filter>
void expectAdaptiveNoise(Filter filter);
TEST(AdaptiveNoise, FindsTheNoiseOfAMeasurement) {
  expectAdaptiveNoise(ErrorStateFilter(Vec2(0, 0), StandardDeviation(1)));
  expectAdaptiveNoise(UnscentedFilter(Vec2(0, 0), StandardDeviation(1)));
}
template <class Filter>
void expectAdaptiveNoise(Filter filter) {
  RandomMatrices random(6);
  const Eigen::Matrix2d R = random.covariance<2>(0.5);
  AdaptiveNoise<2> noise(StandardDeviation(2), 1000);
  Vec2 x(random.vector<2>());
  for (int k = 0; k < 8000; ++k) {
    x += random.vector<2>(0.1);
    ASSERT_TRUE(filter.predict([](const auto& y) { return y; }, StandardDeviation(0.1)));
    ASSERT_TRUE(noise.update(
        filter, [](const auto& y) { return y; }, measured(Vec2(x + random.sample<2>(R)))));
  }
  EXPECT_LT((noise.covariance() - R).norm(), 0.15 * R.norm()) << noise.covariance() << "\n\n" << R;
}

}  // namespace slom::testing
