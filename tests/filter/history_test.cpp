// Late measurements: the history's filter is that of all measurements in the order of their times.
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include <slom/filter.hpp>
#include <slom/filter/history.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

using Vec2 = mtk::vect<2>;

struct ConstantVelocity {
  auto operator()(const auto& x, double dt) const {
    auto y = x;
    y[0] += x[1] * dt;
    return y;
  }
};

struct Fix {
  double time, position;
};

template <class Filter>
FilterStatus predictBy(Filter& f, double dt) {
  return f.predict(ConstantVelocity(), SpectralDensity(Vec2(0, 0.5)), Duration(dt)).status;
}
template <class Filter>
FilterStatus updateBy(Filter& f, double z) {
  return f.update([](const auto& x, double p) { return x[0] - p; }, z, StandardDeviation(0.3)).status;
}

TEST(FilterHistory, IsTheFilterInTheOrderOfTimes) {
  RandomMatrices random(freshSeed());
  for (int run = 0; run < 30; ++run) {
    ErrorStateFilter filter(Vec2(0, 1), StandardDeviation(1));
    std::vector<Fix> fixes;
    for (int i = 0; i < 20; ++i)
      fixes.push_back({i % 3 == 0 ? double(i / 2) : random.uniform(0, 10), random.normal()});
    FilterHistory<decltype(filter), 80> history(filter, 0);
    // Fixes become known up to 3 s late.
    std::vector<std::pair<double, Fix>> arrivals;
    for (const Fix& f : fixes) arrivals.push_back({std::min(10., f.time + random.uniform(0, 3)), f});
    std::sort(arrivals.begin(), arrivals.end(), [](auto& a, auto& b) { return a.first < b.first; });
    std::size_t next = 0;
    for (int k = 1; k <= 10; ++k) {
      ASSERT_EQ(history.predict(k, [](auto& f, double dt) { return predictBy(f, dt); }), FilterStatus::done);
      for (; next < arrivals.size() && arrivals[next].first <= k; ++next) {
        const Fix f = arrivals[next].second;
        ASSERT_EQ(history.update(f.time, [=](auto& g) { return updateBy(g, f.position); }),
                  FilterStatus::done);
      }
    }
    ASSERT_EQ(next, fixes.size());
    std::stable_sort(fixes.begin(), fixes.end(), [](auto& a, auto& b) { return a.time < b.time; });
    double time = 0;
    for (const Fix& f : fixes) {
      if (f.time > time) {
        ASSERT_EQ(predictBy(filter, f.time - time), FilterStatus::done);
      }
      time = f.time;
      ASSERT_EQ(updateBy(filter, f.position), FilterStatus::done);
    }
    if (time < 10) {
      ASSERT_EQ(predictBy(filter, 10 - time), FilterStatus::done);
    }
    EXPECT_LT((history.filter().state() - filter.state()).norm(), 1e-12 * (1 + filter.state().norm()));
    EXPECT_LT((history.filter().covariance() - filter.covariance()).norm(), 1e-12);
  }
}

TEST(FilterHistory, TriesRejectedMeasurementsAgain) {
  const ErrorStateFilter start(Vec2(0, 0), StandardDeviation(1));
  FilterHistory<std::remove_const_t<decltype(start)>, 16> history(start, 0);
  const auto move = [](auto& f, double dt) { return predictBy(f, dt); };
  const auto gated_fix = [](double z, double sigma) {
    return [=](auto& f) {
      return f
          .update([](const auto& x, double p) { return x[0] - p; }, z, StandardDeviation(sigma), Gate(0.99))
          .status;
    };
  };
  for (int k = 1; k <= 3; ++k) ASSERT_EQ(history.predict(k, move), FilterStatus::done);
  ASSERT_EQ(history.update(3, gated_fix(15, 0.3)), FilterStatus::gated);
  const auto before = history.filter();
  ASSERT_EQ(history.update(2.5, gated_fix(20, 0.3)), FilterStatus::gated);  // late
  EXPECT_EQ(history.filter().state(), before.state());                      // to the last bit
  EXPECT_EQ(history.filter().covariance(), before.covariance());

  // The target is fast: now the first rejected measurement fits, the other one does not.
  const auto fast = [](auto& f) {
    return f.update([](const auto& x) { return x[1] - 5; }, StandardDeviation(0.1)).status;
  };
  ASSERT_EQ(history.update(0.5, fast), FilterStatus::done);
  auto in_order = start;
  ASSERT_EQ(predictBy(in_order, 0.5), FilterStatus::done);
  ASSERT_EQ(fast(in_order), FilterStatus::done);
  ASSERT_EQ(predictBy(in_order, 2), FilterStatus::done);
  ASSERT_EQ(gated_fix(20, 0.3)(in_order), FilterStatus::gated);
  ASSERT_EQ(predictBy(in_order, 0.5), FilterStatus::done);
  ASSERT_EQ(gated_fix(15, 0.3)(in_order), FilterStatus::done);
  EXPECT_LT((history.filter().state() - in_order.state()).norm(), 1e-12);
  EXPECT_LT((history.filter().covariance() - in_order.covariance()).norm(), 1e-12);
}

/// Returns a strap-down filter after 1 s of readings at 100 Hz, and a position at 0.503 s that comes at 0.8 s or in time.
ErrorStateFilter<filter::StrapdownState<>> flyWithLateFix(bool is_late) {
  using Vec3 = mtk::vect<3>;
  const ImuNoise imu{1e-3, 1e-2, 1e-5, 1e-4};
  const ErrorStateFilter start(filter::StrapdownState<>(), StandardDeviation(0.1));
  FilterHistory<std::remove_const_t<decltype(start)>, 64, 512> history(start, 0);
  const auto predictTo = [&](double time) {
    const Vec3 gyro(0.1, 0.2, 0.3), force(1, 0, 9.81);
    EXPECT_EQ(history.predict(time,
                              [=](auto& f, double dt) {
                                return f.predict(filter::Strapdown(), filter::strapdownNoise(imu, dt), gyro,
                                                 force, dt);
                              }),
              FilterStatus::done);
  };
  const auto fix = [](auto& f) {
    return f.update(filter::GnssPosition(), Vec3(0.3, 0.2, 0.1), Vec3(0, 0, 1), StandardDeviation(0.05));
  };
  for (int k = 1; k <= 100; ++k) {
    if (k == 51 && !is_late) {
      predictTo(0.503);
      EXPECT_EQ(history.update(0.503, fix), FilterStatus::done);
    }
    predictTo(k * 0.01);
    if (k == 80 && is_late) {
      EXPECT_EQ(history.update(0.503, fix), FilterStatus::done);
    }
  }
  return history.filter();
}
TEST(FilterHistory, TakesLatePositionsOfStrapdownNavigation) {
  const auto late = flyWithLateFix(true), in_time = flyWithLateFix(false);
  EXPECT_LT((late.state().pose.pos - in_time.state().pose.pos).norm(), 1e-12);
  EXPECT_LT((late.covariance() - in_time.covariance()).norm(), 1e-12);
}

TEST(FilterHistory, TakesCovariancesOfTheDuration) {
  const auto variancesAfter = [](bool is_divided) {
    FilterHistory<ErrorStateFilter<Vec2>, 8> history(ErrorStateFilter(Vec2(0, 0), StandardDeviation(1)), 0);
    EXPECT_EQ(history.predict(1,
                              [](auto& f, double dt) {
                                return f.predict([](const auto& x, double) { return x; },
                                                 grownCovariance(dt, [](double h) { return Vec2(h, 2 * h); }),
                                                 dt);
                              }),
              FilterStatus::done);
    if (is_divided) {
      EXPECT_EQ(history.update(0.3,
                               [](auto& f) {
                                 return f.update([](const auto& x) { return x[0]; }, StandardDeviation(1e6));
                               }),
                FilterStatus::done);
    }
    return Vec2(history.filter().covariance().diagonal());
  };
  EXPECT_LT((variancesAfter(false) - Vec2(2, 3)).norm(), 1e-12);
  EXPECT_LT((variancesAfter(true) - Vec2(2, 3)).norm(), 1e-9);
}

TEST(FilterHistory, RefusesTimesOutside) {
  FilterHistory<ErrorStateFilter<Vec2>, 3> history(ErrorStateFilter(Vec2(0, 1), StandardDeviation(1)), 5);
  const auto move = [](auto& f, double dt) { return predictBy(f, dt); };
  const auto fix = [](auto& f) { return updateBy(f, 0); };
  EXPECT_EQ(history.predict(5, move), FilterStatus::bad_duration);
  EXPECT_EQ(history.update(4.9, fix), FilterStatus::too_old);
  EXPECT_EQ(history.update(5.1, fix), FilterStatus::too_old);  // not predicted yet
  for (int k = 6; k < 10; ++k) EXPECT_EQ(history.predict(k, move), FilterStatus::done);
  EXPECT_EQ(history.begin(), 6);  // three steps are kept
  EXPECT_EQ(history.update(5.5, fix), FilterStatus::too_old);
  EXPECT_EQ(history.update(8.5, fix), FilterStatus::done);
  EXPECT_EQ(history.begin(), 8);
  EXPECT_EQ(history.time(), 9);
}

}  // namespace slom::testing
