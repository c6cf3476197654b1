// Navigation on recorded data: an IMU with positions at 1 Hz and with gaps of 10 s (EuRoC V1_02), and a wheeled robot.
// Positions are the truth with simulated noise.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>
#include <slom/filter.hpp>

#include "csv.hpp"
#include "support/paths.hpp"

namespace slom::testing {

using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;

/// e^T P^-1 e for the first N components.
template <int N, class P>
double squaredLength(const P& covariance, const mtk::vect<N>& e) {
  detail::SquareMatrix<double, N> L;
  EXPECT_TRUE(
      detail::factorize<N>(detail::SquareMatrix<double, N>(covariance.template topLeftCorner<N, N>()), L));
  mtk::vect<N> w = e;
  detail::solveLower<N>(L, w);
  return w.squaredNorm();
}

struct Flight {
  double position_rms = 0;  ///< before each update, from 10 s on [m]
  double nees = 0;          ///< of these positions, per component
  double drift = 0;         ///< after a gap of 10 s that begins after 20 s [m]
  double drift_sigma = 0;   ///< as stated [m]
};

/// Flies with positions at 1 Hz, +- 0.1 m; if `gap`, without those of [20 s, 30 s).
Flight fly(bool has_gap, unsigned seed) {
  const auto imu = readRows(sharedDataPath("inertial_truth/imu0.csv")),
             truth = readRows(sharedDataPath("inertial_truth/truth.csv"));
  mtk::testing::Random random(seed);
  const auto noise = [&](double sigma) {
    return Vec3(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
  };
  const auto vector = [](const std::vector<double>& row, std::size_t i) {
    return Vec3(row[i], row[i + 1], row[i + 2]);
  };

  filter::StrapdownState<> x;
  x.pose.orient =
      mtk::SO3<>(truth[0][4], truth[0][5], truth[0][6], truth[0][7]) * mtk::SO3<>::exp(noise(0.05));
  x.pose.pos = vector(truth[0], 1) + noise(0.1);
  x.velocity = vector(truth[0], 8) + noise(0.1);
  mtk::vect<15> start;
  start << 0.1, 0.1, 0.1, 0.05, 0.05, 0.05, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0.2;
  ErrorStateFilter filter(x, StandardDeviation(start));
  // 6 and 20 times the densities of the data sheet, for vibration and axes that are not calibrated.
  const ImuNoise imu_noise{1e-3, 4e-2, 2e-5, 3e-3};

  Flight flight;
  int updates = 0;
  double last = truth[0][0], next_update = 1;
  std::size_t k = 0;
  for (std::size_t i = 1; i < imu.size() && k < truth.size(); ++i) {
    if (imu[i][0] <= truth[0][0]) continue;
    const double dt = (imu[i][0] - last) * 1e-9, time = (imu[i][0] - truth[0][0]) * 1e-9;
    last = imu[i][0];
    const Vec3 gyro((vector(imu[i - 1], 1) + vector(imu[i], 1)) / 2),
        force((vector(imu[i - 1], 4) + vector(imu[i], 4)) / 2);
    EXPECT_TRUE(filter.predict(filter::Strapdown(), filter::strapdownNoise(imu_noise, dt), gyro, force, dt));
    while (k < truth.size() && truth[k][0] < imu[i][0] - 1e6) ++k;
    if (k == truth.size() || std::abs(truth[k][0] - imu[i][0]) > 1e6 || time < next_update) continue;
    next_update += 1;
    const Vec3 e(vector(truth[k], 1) - filter.state().pose.pos);
    const bool in_gap = has_gap && time >= 20 && time < 30;
    if (has_gap && time >= 30 && flight.drift == 0) {
      flight.drift = e.norm();
      flight.drift_sigma = filter.standardDeviations().head<3>().norm();
    }
    if (time > 10 && !has_gap) {
      flight.position_rms += e.squaredNorm();
      flight.nees += squaredLength<3>(filter.covariance(), e) / 3;
      ++updates;
    }
    if (!in_gap) {
      EXPECT_TRUE(filter.update(filter::GnssPosition(), Vec3(vector(truth[k], 1) + noise(0.1)), Vec3(0, 0, 0),
                                StandardDeviation(0.1)));
    }
  }
  flight.position_rms = std::sqrt(flight.position_rms / std::max(updates, 1));
  flight.nees /= std::max(updates, 1);
  return flight;
}

TEST(Strapdown, FollowsARobotThroughGaps) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("inertial_truth/imu0.csv");
  double rms = 0, nees = 0, drift = 0, sigma = 0;
  const int runs = 10;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const Flight all = fly(false, seed), gap = fly(true, seed);
    rms += all.position_rms / runs;
    nees += all.nees / runs;
    drift += gap.drift / runs;
    sigma += gap.drift_sigma / runs;
    EXPECT_LT(gap.drift, 3.5 * gap.drift_sigma) << seed;
  }
  std::printf("position 1 s after an update %.2f m, NEES %.2f; after 10 s %.1f m, stated %.1f m\n", rms, nees,
              drift, sigma);
  EXPECT_LT(rms, 0.35);
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 1.5);
  EXPECT_LT(drift, 15);
}

TEST(WheelOdometry, WithPositionsKeepsTheHeading) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("wheel_odometry/wifibot.csv");
  const auto rows = readRows(sharedDataPath("wheel_odometry/wifibot.csv"));
  const auto truth = [&](std::size_t i) {
    return mtk::trafo<mtk::SO2<>>(mtk::SO2<>(rows[i][4]), Vec2(rows[i][5], rows[i][6]));
  };
  mtk::testing::Random random(1);
  filter::WheelState<> x;
  x.pose = truth(0);
  mtk::vect<4> start;
  start << 0.1, 0.1, 0.1, 0.02;
  ErrorStateFilter filter(x, StandardDeviation(start));
  double position = 0, heading = 0, nees = 0, next_update = rows[0][0] + 1;
  int updates = 0, count = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double dt = rows[i][0] - rows[i - 1][0], rate = rows[i][1];
    const Vec2 velocity(rows[i][2], rows[i][3]);
    ASSERT_TRUE(filter.predict(filter::WheelOdometry(),
                               filter::wheelNoise(filter::WheelNoise<>(), velocity, rate, dt), velocity, rate,
                               dt));
    const auto e = mtk::difference(truth(i), filter.state().pose);
    if (rows[i][0] > 20) {
      position += e.head<2>().squaredNorm();
      heading += e[2] * e[2];
      ++count;
    }
    if (rows[i][0] < next_update) continue;
    next_update += 1;
    nees += squaredLength<3>(filter.covariance(), mtk::vect<3>(e)) / 3;
    ++updates;
    const Vec2 gps(truth(i).pos + Vec2(0.1 * random.normal(), 0.1 * random.normal()));
    ASSERT_TRUE(filter.update(filter::PlanePosition(), gps, Vec2(0, 0), StandardDeviation(0.1)));
  }
  position = std::sqrt(position / count);
  heading = std::sqrt(heading / count) * 57.29577951308232;
  std::printf("RMS position %.3f m, heading %.2f degrees, NEES %.2f\n", position, heading, nees / updates);
  EXPECT_LT(position, 0.08);
  EXPECT_LT(heading, 4);
  EXPECT_LT(nees / updates, 1.3);
  EXPECT_GT(nees / updates, 0.4);
}

}  // namespace slom::testing
