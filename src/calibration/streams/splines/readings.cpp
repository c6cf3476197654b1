// The readings of an IMU and its biases in a fit by splines.
#include <cmath>
#include <string>
#include <utility>

#include "calibration/median.hpp"
#include "calibration/streams/bias_jumps.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/mean_bias.hpp"
#include "calibration/streams/splines/problem.hpp"
#include "calibration/streams/splines/reading_on_spline.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double bias_spacing = 1;  ///< between knots of biases [s]

/// Returns readings per second.
double rateOf(const ImuStream& stream) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stream.samples.size(); ++i)
    intervals.push_back(stream.samples[i].time - stream.samples[i - 1].time);
  return 1 / medianOf(intervals);
}

}  // namespace

std::vector<VarID<vec3>> SplineProblem::biasesBeforeJumps(const Imu& imu, bool is_gyro) {
  const Bias& bias = is_gyro ? imu.gyro_bias : imu.force_bias;
  const double jump = firstJump(imu.jumps, is_gyro);
  std::vector<VarID<vec3>> before;
  for (std::size_t k = 0; k < bias.controls().size(); ++k) {
    if (bias.firstTime() + bias_spacing * double(k) < jump) before.push_back(bias.controls()[k]);
  }
  if (before.empty()) before.assign(bias.controls().begin(), bias.controls().end());
  return before;
}

ImuModel<> SplineProblem::modelOf(const Imu& imu) {
  return imu.axes.modelWith(meanBias(imu.gyro_bias.controls()), meanBias(imu.force_bias.controls()));
}

void SplineProblem::insert(const StartedImu& started) {
  const ImuStream& stream = *started.stream;
  const auto bias = [&](const std::string& name, const std::function<vec3(double)>& start) {
    const double first = stream.samples.front().time;
    Bias spline(trajectory::Knots(first, bias_spacing), stream.name + "." + name);
    spline.extend(est_, first, stream.samples.back().time, start);
    return spline;
  };
  const SplineValues::Biases start =
      start_.biases.empty() ? SplineValues::Biases{[&](double) { return started.start.gyro_bias; },
                                                   [&](double) { return started.force_bias; }}
                            : start_.biases[imus_.size()];
  imus_.push_back({&stream,
                   started.noise,
                   rateOf(stream),
                   started.jumps,
                   est_.insertRV(started.left2imu, true, stream.name + ".pose"),
                   est_.insertRV(mtk::Scalar<>(started.start.offset), true, stream.name + ".time_offset"),
                   {},
                   bias("gyro_bias", start.gyro),
                   bias("acc_bias", start.force),
                   {}});
  imus_.back().axes.insert(est_, started.axes, started.model, stream.name);
  insertReadings(imus_.back());
  insertWalk(imus_.back(), started.jumps);
}

void SplineProblem::insertReadings(Imu& imu) {
  const std::vector<Stretch>& stretches = recording_.stretches;
  const double offset = double(*imu.offset);
  std::size_t s = 0;
  for (const ImuSample& sample : imu.stream->samples) {
    const double time = sample.time - offset;
    while (s < stretches.size() && time > stretches[s].to) ++s;
    if (s == stretches.size()) break;
    if (time >= stretches[s].from) insertReading(imu, s, sample, timeGroup(time));
  }
  if (imu.readings.empty())
    throw DataError("slom.calibration.bad-stream",
                    {.place = nameOf(*imu.stream),
                     .fault = "there are no readings between any two successive images",
                     .remedy = "give images and readings of the same motion"});
}

void SplineProblem::insertReading(Imu& imu, std::size_t stretch, const ImuSample& sample, const Group& time) {
  const double t = sample.time;
  const auto pose = splines_[stretch].around([offset = imu.offset, t] { return t - double(*offset); });
  const auto insert = [&](const auto& function, const Bias& bias, const vec3& reading, double density,
                          const char* sensor, const auto&... variables) {
    return trajectory::insertMeasurement(
        est_, function, pose, bias.around(t), imu.left2imu, imu.offset, variables..., t, measured(reading),
        StandardDeviation(density * std::sqrt(imu.rate)), time, named(imu.stream->name + sensor));
  };
  const auto gyro = [&](const auto& function, const auto&... variables) {
    return insert(function, imu.gyro_bias, sample.gyro, imu.noise.gyro, " gyro", variables...);
  };
  const auto force = [&](const auto& function, const auto&... variables) {
    return insert(function, imu.force_bias, sample.force, imu.noise.force, " acc", up_, board_scale_,
                  variables...);
  };
  const double gravity = recording_.gravity;
  const AxesVariables& axes = imu.axes;
  imu.readings.push_back(
      axes.exist() ? Reading{&sample, stretch,
                             gyro(GyroWithAxesOnSpline{gravity}, up_, board_scale_, axes.gyro_axes,
                                  axes.gyro_by_force),
                             force(ForceWithAxesOnSpline{gravity}, axes.force_axes, axes.force_places)}
                   : Reading{&sample, stretch, gyro(GyroOnSpline()), force(ForceOnSpline{gravity})});
}

void SplineProblem::insertWalk(const Imu& imu, const std::vector<BiasJump>& jumps) {
  const auto step = [](const auto& before, const auto& after) { return after - before; };
  const double offset = double(*imu.offset);
  const auto insert = [&](const Bias& bias, bool is_gyro, double density) {
    for (std::size_t k = 1; k < bias.controls().size(); ++k) {
      const double to = bias.firstTime() + bias_spacing * double(k), from = to - bias_spacing;
      est_.insertMeasurement(step, bias.controls()[k - 1], bias.controls()[k],
                             StandardDeviation(incrementDeviation(jumps, is_gyro, density, from, to)),
                             timeGroup(to - offset), named("bias walk"));
    }
  };
  insert(imu.gyro_bias, true, imu.noise.gyro_walk);
  insert(imu.force_bias, false, imu.noise.force_walk);
}

}  // namespace slom::calibration
