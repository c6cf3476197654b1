// One motion and one measurement function, used four times: by a filter in real time, by its smoother, by a window and by
// a fit of all poses. A robot drives a circle; odometry says how it moves, and ranges to beacons correct it.
// Units: metre, radian, second.
#include <cmath>
#include <cstdio>
#include <vector>

#include <mtk/testing/random.hpp>
#include <slom/filter.hpp>
#include <slom/fixed_lag.hpp>
#include <slom/slom.hpp>

using Point = mtk::vect<2>;
using Pose = mtk::trafo<mtk::SO2<>>;  // world_T_robot

/// The pose after a step: forward, then a turn. A vector, because a number at the end would be the duration of a step.
using Odometry = mtk::vect<2>;
struct Drive {
  auto operator()(const auto& pose, const Odometry& step) const {
    return pose * Pose(mtk::SO2<>(step[1]), Point(step[0], 0));
  }
};
/// The distance of a beacon from the robot, minus the reading.
struct RangeError {
  auto operator()(const auto& pose, const Point& beacon, double reading) const {
    return (beacon - pose.pos).norm() - reading;
  }
};

int main() {
  const Point beacons[] = {Point(6, 0), Point(-5, 4), Point(0, 9)};
  const mtk::vect<3> step_sigma(0.05, 0.05, 0.03), start_sigma(0.2, 0.2, 0.2);
  const double range_sigma = 0.1;
  const Odometry step(0.5, 0.1);

  // A drive of 60 steps with noise.
  mtk::testing::Random random(1);
  std::vector<Pose> truth{Pose()};
  std::vector<double> ranges;
  for (int k = 0; k < 60; ++k) {
    const mtk::vect<3> noise(0.05 * random.normal(), 0.05 * random.normal(), 0.03 * random.normal());
    truth.push_back(mtk::moved(Drive()(truth.back(), step), noise));
    for (const Point& beacon : beacons)
      ranges.push_back((beacon - truth.back().pos).norm() + range_sigma * random.normal());
  }

  // In real time; the smoother looks back at the end.
  const slom::ErrorStateFilter start(Pose{}, slom::StandardDeviation(start_sigma));
  slom::RtsSmoother run(start);
  std::vector<Pose> filtered{Pose()};
  for (std::size_t k = 0; k < 60; ++k) {
    const auto prediction = run.predict(Drive(), slom::StandardDeviation(step_sigma), step);
    if (!prediction) std::puts(prediction.message());
    for (std::size_t b = 0; b < 3; ++b) {
      const auto update = run.update(RangeError(), beacons[b], ranges[3 * k + b],
                                     slom::StandardDeviation(range_sigma), slom::Iterations(5));
      if (!update) std::puts(update.message());
    }
    filtered.push_back(run.filter().state());
  }
  const auto smoothed = run.smoothed();

  // All poses at once, and the newest 10 of them.
  const auto fit = [&](bool has_window) {
    slom::Estimator est;
    slom::FixedLag window({.variables = 10});
    std::vector<slom::VarID<Pose>> ids{est.insertRV(Pose())};
    std::vector<Pose> newest{Pose()};
    est.insertMeasurement(slom::Prior(), ids[0], slom::measured(Pose()),
                          slom::StandardDeviation(start_sigma));
    if (has_window) window.add(ids[0], 0);
    for (std::size_t k = 0; k < 60; ++k) {
      ids.push_back(est.insertRV(Drive()(*ids.back(), step)));
      est.insertMeasurement(
          [](const auto& before, const auto& after, const Odometry& driven) {
            const auto predicted = Drive()(before, driven);
            const auto apart = after.orient.inverse() * predicted.orient;
            return mtk::vector(after.pos[0] - predicted.pos[0], after.pos[1] - predicted.pos[1],
                               -apart.angle());
          },
          ids[k], ids[k + 1], step, slom::StandardDeviation(step_sigma));
      for (std::size_t b = 0; b < 3; ++b)
        est.insertMeasurement(RangeError(), ids[k + 1], beacons[b], ranges[3 * k + b],
                              slom::StandardDeviation(range_sigma));
      if (has_window) {
        window.add(ids[k + 1], double(k + 1));
        est.optimize();
        newest.push_back(*ids[k + 1]);
        window.forget(est);
      }
    }
    if (has_window) return newest;
    est.optimize();
    std::vector<Pose> all;
    for (const auto& id : ids) all.push_back(*id);
    return all;
  };

  const auto error = [&](const auto& at) {
    double sum = 0;
    for (std::size_t k = 0; k <= 60; ++k) sum += (at(k).pos - truth[k].pos).squaredNorm();
    return std::sqrt(sum / 61);
  };
  const auto batch = fit(false), window = fit(true);
  double between = 0;
  for (std::size_t k = 0; k <= 60; ++k)
    between = std::fmax(between, (smoothed[k].state.pos - batch[k].pos).norm());
  std::printf("RMS error of the position: filter %.3f m, window %.3f m, smoother %.3f m, fit %.3f m\n",
              error([&](std::size_t k) { return filtered[k]; }),
              error([&](std::size_t k) { return window[k]; }),
              error([&](std::size_t k) { return smoothed[k].state; }),
              error([&](std::size_t k) { return batch[k]; }));
  std::printf("smoother and fit differ by less than 0.01 m: %s\n", between < 0.01 ? "yes" : "no");
}
