// Time per step of the 15-state navigation filter, beside the same filter by hand with Eigen. Both end at the same state.
//   line   filter; median time of a prediction and of an update [us], of 15 rounds; ratio to the filter by hand
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include <slom/filter/error_state_filter.hpp>
#include <slom/filter/models/strapdown.hpp>

#include "by_hand.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using Vec3 = mtk::vect<3>;
constexpr int kSteps = 4000, kRounds = 15;
constexpr double kDt = 0.005;

Vec3 gyroAt(int k) { return Vec3(0.3 * std::sin(0.01 * k), 0.2, 0.5 * std::cos(0.007 * k)); }
Vec3 forceAt(int k) { return Vec3(0.5 * std::sin(0.02 * k), 0.1, 9.81 + 0.3 * std::cos(0.01 * k)); }

struct Times {
  double predict = 1e9, update = 1e9;  ///< [us]
};
double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + long(x.size() / 2), x.end());
  return x[x.size() / 2];
}

/// Runs predictions with an update after every 10th; returns the median times of both.
template <class Make, class Predict, class Update>
Times timeOf(const Make& make, const Predict& predict, const Update& update) {
  std::vector<double> predictions, updates;
  for (int round = 0; round < kRounds; ++round) {
    auto filter = make();
    double p = 0, u = 0;
    for (int k = 0; k < kSteps; k += 10) {
      const auto begin = Clock::now();
      for (int i = k; i < k + 10; ++i) predict(filter, i);
      const auto middle = Clock::now();
      for (int i = 0; i < 5; ++i) update(filter, Vec3(0.01 * i, 0, 0));
      const auto end = Clock::now();
      p += std::chrono::duration<double, std::micro>(middle - begin).count();
      u += std::chrono::duration<double, std::micro>(end - middle).count();
    }
    predictions.push_back(p / kSteps);
    updates.push_back(u / (kSteps / 2));
  }
  return {median(predictions), median(updates)};
}

}  // namespace

int main() {
  const slom::ImuNoise imu{1e-3, 1e-2, 1e-5, 1e-4};
  const auto Q = slom::filter::strapdownNoise(imu, kDt);
  const Eigen::Matrix<double, 15, 15> Q_by_hand = Q.value;
  by_hand::Filter end_by_hand;
  const Times by_hand_times = timeOf(
      [] {
        by_hand::Filter filter;
        filter.P = 0.01 * by_hand::Mat15::Identity();
        return filter;
      },
      [&](auto& filter, int k) {
        filter.predict(gyroAt(k), forceAt(k), kDt, Q_by_hand), end_by_hand = filter;
      },
      [](auto& filter, const Vec3& position) { filter.updatePosition(position, 0.1); });

  const auto run = [&](const char* name, const auto& make) {
    auto end = make();
    int refusals = 0;
    const Times times = timeOf(
        make,
        [&](auto& filter, int k) {
          refusals += !filter.predict(slom::filter::Strapdown(), Q, gyroAt(k), forceAt(k), kDt);
          end = filter;
        },
        [&](auto& filter, const Vec3& position) {
          refusals += !filter.update(slom::filter::GnssPosition(), position, Vec3(0, 0, 0),
                                     slom::StandardDeviation(0.1));
        });
    std::printf("%-24s %7.3f %7.3f   %.2f %.2f\n", name, times.predict, times.update,
                times.predict / by_hand_times.predict, times.update / by_hand_times.update);
    const double off =
        (end.state().pose.pos - end_by_hand.p).norm() + (end.covariance() - end_by_hand.P).norm();
    if (!(off < 1e-8) || refusals > 0) {
      std::printf("%s ends elsewhere than the filter by hand, by %g, after %d refusals\n", name, off,
                  refusals);
      std::exit(1);
    }
  };
  std::printf("%-24s %7s %7s   ratios\n", "filter", "predict", "update");
  std::printf("%-24s %7.3f %7.3f\n", "by hand, Eigen", by_hand_times.predict, by_hand_times.update);
  const slom::filter::StrapdownState<> start;
  run("ErrorStateFilter", [&] { return slom::ErrorStateFilter(start, slom::StandardDeviation(0.1)); });
  run("ErrorStateFilter, root",
      [&] { return slom::ErrorStateFilter(start, slom::StandardDeviation(0.1), slom::square_root); });
}
