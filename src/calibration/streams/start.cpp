#include "calibration/streams/start.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "calibration/median.hpp"
#include "calibration/streams/between_images.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/forces.hpp"
#include "calibration/streams/rates.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns the correlation of the magnitudes.
double correlationOf(const RatePairs& pairs) {
  const double n = double(pairs.camera.size());
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < pairs.camera.size(); ++i) {
    const double x = pairs.camera[i].norm(), y = pairs.gyro[i].norm();
    a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
  }
  const double spread = (aa - a * a / n) * (bb - b * b / n);
  return spread > 0 ? (ab - a * b / n) / std::sqrt(spread) : 0;
}

struct Peak {
  double offset = 0, correlation = -1, evidence = -1;
};

/// Returns the best offset on a grid. Evidence grows with the number of common intervals: Fisher's z.
Peak bestOnGrid(double first, double last, double step, std::size_t fewest,
                const std::vector<CameraRate>& rates, const GyroIntegral& gyro) {
  Peak best;
  for (double offset = first; offset <= last; offset += step) {
    const RatePairs pairs = pairsAt(offset, rates, gyro);
    if (pairs.camera.size() < fewest) continue;
    const double r = std::min(correlationOf(pairs), 1 - 1e-9);
    const double evidence = std::atanh(r) * std::sqrt(double(pairs.camera.size()));
    if (evidence > best.evidence) best = {offset, r, evidence};
  }
  return best;
}

/// Returns a clause on readings that come so fast or so slowly that their times may have another unit; empty otherwise.
std::string strangeRate(const ImuStream& imu) {
  constexpr double least = 5, most = 20e3;  // Hz
  const double duration = imu.samples.back().time - imu.samples.front().time,
               rate = double(imu.samples.size() - 1) / duration;
  if (rate > least && rate < most) return {};
  return fmt::format("; {} readings come within {:.3g} s, so check the unit of their times",
                     imu.samples.size(), duration);
}

double spreadOf(const std::vector<vec3>& rates) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const vec3& rate : rates) mean += rate / double(rates.size());
  double square = 0;
  for (const vec3& rate : rates) square += (rate - mean).squaredNorm() / double(rates.size());
  return std::sqrt(square);
}

/// Refuses angular velocities in degrees, and axes of the other hand.
void requireUnitsAndHand(const ImuStream& imu, const std::vector<RigAtImage>& images, double offset,
                         const RatePairs& pairs) {
  const double ratio = spreadOf(pairs.gyro) / spreadOf(pairs.camera);
  constexpr double degrees = 57.29578;
  if (ratio > 0.7 * degrees && ratio < 1.4 * degrees)
    badStream(
        imu,
        fmt::format(
            "the angular velocities are {:.3g} times those of the cameras, as if they were in degrees per second",
            ratio),
        "convert them to rad/s");
  if (ratio < 0.7 || ratio > 1.4)
    badStream(imu, fmt::format("the angular velocities are {:.3g} times those of the cameras", ratio),
              "give rad/s, and the times of both sensors in one unit");
  const double right = align(pairs, false).rms, mirrored = align(pairs, true).rms;
  if (mirrored < right / 2)
    badStream(
        imu,
        fmt::format("the angular velocities fit axes of the other hand: {:.2g} rad/s off instead of {:.2g}",
                    mirrored, right),
        remedyOfHand(imu, images, {offset, SO3(), vec3(0., 0., 0.)}, align(pairs, true).R));
}

/// Refuses angular velocities that follow those of the cameras in magnitude, but not in direction.
void requireSameMotion(const ImuStream& imu, const RatePairs& pairs, const RatesAlignment& aligned) {
  constexpr double most_share = 0.7;  // half of the squares
  const double spread = spreadOf(pairs.gyro);
  if (aligned.rms <= most_share * spread) return;
  throw DataError(
      "slom.calibration.no-motion",
      {.place = nameOf(imu),
       .fault = fmt::format(
           "the angular velocities vary by {:.2g} rad/s and are {:.2g} rad/s from those of the cameras, turned as fits best",
           spread, aligned.rms),
       .remedy = "give images and readings of the same motion, with quick turns about all axes"});
}

/// Refuses turns about one axis: the place of the IMU along the axis then changes no reading.
void requireAxes(const ImuStream& imu, const RatePairs& pairs, const RatesAlignment& aligned) {
  constexpr double least_share = 0.01;  // of the second axis in the rates: about what noise amounts to
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const vec3& rate : pairs.gyro) {
    const Eigen::Vector3d turn = rate - aligned.bias;
    squares += turn * turn.transpose() / double(pairs.gyro.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares);
  const double largest = std::sqrt(axes.eigenvalues()[2]),
               second = std::sqrt(std::max(0., axes.eigenvalues()[1]));
  if (second >= least_share * largest) return;
  Eigen::Vector3d axis = axes.eigenvectors().col(2);
  if (axis.sum() < 0) axis = -axis;
  throw DataError(
      "slom.calibration.no-motion",
      {.place = nameOf(imu),
       .fault = fmt::format(
           "the rig turns about one axis only, ({:.2f}, {:.2f}, {:.2f}) in the axes of the IMU, so the position of the "
           "IMU along this axis is not determined",
           axis[0], axis[1], axis[2]),
       .remedy = "turn the rig about all axes"});
}

/// The turn between two images as the gyroscope says, minus that of the camera.
struct TurnBetweenImages {
  ImuBetweenImages readings;
  SO3 turn;

  auto operator()(const auto& left2imu, const auto& gyro_bias, const auto& offset) const {
    const auto moved =
        readings.motion(offset, gyro_bias, std::decay_t<decltype(gyro_bias)>(vec3(0., 0., 0.)));
    const auto seen = left2imu * turn * left2imu.inverse();
    return std::decay_t<decltype(seen)>::log(moved.rotation.inverse() * seen);
  }
};

/// Improves the start by all turns between images, robustly.
void refine(const ImuStream& imu, const std::vector<RigAtImage>& images, RatesStart& start) {
  constexpr double sigma = 0.005, reach = 1.345;  // rad: the noise of single poses, and Huber's scale
  Estimator est;
  const ImuSamples samples(imu.samples);
  const auto left2imu = est.insertRV(start.left2imu, true, "left2imu");
  const auto bias = est.insertRV(start.gyro_bias, true, "gyro_bias");
  const auto offset = est.insertRV(mtk::Scalar<>(start.offset), true, "offset");
  for (std::size_t i = 1; i < images.size(); ++i) {
    const RigAtImage &a = images[i - 1], &b = images[i];
    if (b.time - a.time > longest_pair || a.time + start.offset < samples.begin() ||
        b.time + start.offset > samples.end())
      continue;
    est.insertMeasurement(
        TurnBetweenImages{{samples, a.time, b.time, 0}, a.left2world.orient.inverse() * b.left2world.orient},
        left2imu, bias, offset, StandardDeviation(sigma), Huber(reach));
  }
  Options options;
  options.max_iterations = 50;
  options.most_parameters = 0;
  options.deviation_tolerance = 1e-3;
  est.optimize(options);
  start.left2imu = *left2imu;
  start.gyro_bias = *bias;
  start.offset = double(*offset);
}

}  // namespace

RatesStart startByRates(const ImuStream& imu, const std::vector<RigAtImage>& images,
                        const std::optional<double>& given) {
  const std::vector<CameraRate> rates = cameraRates(images);
  const std::string place = nameOf(imu);
  if (rates.size() < 10)
    throw DataError("slom.calibration.bad-stream",
                    {.place = place,
                     .fault = fmt::format("only {} pairs of images follow each other within {} s",
                                          rates.size(), longest_pair),
                     .remedy = "record images at 4 Hz or more"});
  const GyroIntegral gyro(imu);
  std::vector<double> spacings;
  for (const CameraRate& rate : rates) spacings.push_back(rate.to - rate.from);
  const double spacing = medianOf(spacings), step = spacing / 2;
  const double camera_length = rates.back().to - rates.front().from,
               imu_length = imu.samples.back().time - imu.samples.front().time;
  const double fraction = std::min(1., imu_length / camera_length) / 3;
  const std::size_t fewest = std::max<std::size_t>(10, std::size_t(fraction * double(rates.size())));
  const double first = given ? *given - 5 * spacing : imu.samples.front().time - rates.back().to;
  const double last = given ? *given + 5 * spacing : imu.samples.back().time - rates.front().from;
  Peak peak = bestOnGrid(first, last, step, fewest, rates, gyro);
  if (peak.evidence < 0)
    badStream(imu,
              (given ? "no image was taken while the IMU recorded, with this time offset"
                     : "the recordings are too short to find the time offset") +
                  strangeRate(imu),
              "give images and readings of the same motion");
  peak = bestOnGrid(peak.offset - step, peak.offset + step, step / 20, fewest, rates, gyro);
  constexpr double least_correlation = 0.5;
  constexpr double least_evidence = 6;  // the best of all offsets reaches 4 by chance
  if (peak.correlation < least_correlation || peak.evidence < least_evidence)
    throw DataError(
        "slom.calibration.no-motion",
        {.place = place,
         .fault = fmt::format(
             "the angular velocities and the turns of the cameras correlate by {:.2g} at best, so their clocks cannot be "
             "compared{}",
             peak.correlation, strangeRate(imu)),
         .remedy = "give images and readings of the same motion, with quick turns about all axes"});
  const RatePairs pairs = pairsAt(peak.offset, rates, gyro);
  requireUnitsAndHand(imu, images, peak.offset, pairs);
  const RatesAlignment aligned = align(pairs, false);
  requireSameMotion(imu, pairs, aligned);
  requireAxes(imu, pairs, aligned);
  RatesStart start{peak.offset, SO3(aligned.R), aligned.bias, peak.correlation};
  refine(imu, images, start);
  return start;
}

mtk::S2<> upByForces(const ImuStream& imu, const std::vector<RigAtImage>& images, const RatesStart& start) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t next = 0;
  for (const RigAtImage& image : images) {
    while (next + 1 < imu.samples.size() && imu.samples[next].time < image.time + start.offset) ++next;
    sum += image.left2world.orient * (start.left2imu.inverse() * imu.samples[next].force);
  }
  return mtk::S2<>(vec3(sum));
}

std::vector<vec3> velocitiesOf(const std::vector<RigAtImage>& images) {
  std::vector<vec3> velocities;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const RigAtImage &a = images[i == 0 ? 0 : i - 1], &b = images[std::min(i + 1, images.size() - 1)];
    velocities.push_back(b.time > a.time ? vec3((b.left2world.pos - a.left2world.pos) / (b.time - a.time))
                                         : vec3(0., 0., 0.));
  }
  return velocities;
}

}  // namespace slom::calibration
