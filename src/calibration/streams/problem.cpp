#include "calibration/streams/problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "calibration/models/lens.hpp"
#include "calibration/rotation_vector.hpp"
#include "calibration/streams/check.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns the number of successive images in a group of errors that may depend on each other: about 48 groups, enough to
/// join neighbours until the variance no longer grows.
std::int64_t blockLength(std::size_t images) {
  constexpr std::size_t groups = 48;
  return std::int64_t(std::max<std::size_t>(1, images / groups));
}

constexpr double least_density = 1e-7;  ///< of noise that is estimated

/// Returns a sentence on the direction in which the pose of an IMU is hardly determined, or nothing. `covariance`: of
/// left2imu.
std::string openDirectionOf(const std::string& name, const Eigen::MatrixXd& covariance) {
  constexpr double most = 0.1;  // m and rad: what a ruler finds
  const auto sentence = [&](const char* what, int first, double unit, const char* unit_name,
                            const char* frame) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance.block<3, 3>(first, first));
    const double std = std::sqrt(std::max(0., axes.eigenvalues()[2]));
    if (std < most) return std::string();
    Eigen::Vector3d axis = axes.eigenvectors().col(2);
    if (axis.sum() < 0) axis = -axis;
    return fmt::format(
        "{} of {} {} ({:.2f}, {:.2f}, {:.2f}) in the axes of {} is known to {:.2g} {} only; turn the rig about all axes, "
        "quickly",
        what, name, first == 0 ? "along" : "about", axis[0], axis[1], axis[2], frame, std * unit, unit_name);
  };
  const std::string place = sentence("the position", 0, 1, "m", "the IMU");
  return place.empty() ? sentence("the orientation", 3, 180 / std::numbers::pi, "deg", "the reference camera")
                       : place;
}

/// Removes all standard deviations.
void forgetDeviations(StreamResult& result) {
  result.gravity_direction_std = unknown;
  const vec3 none(unknown, unknown, unknown);
  for (ImuStreamResult& imu : result.imus) {
    imu.translation_std = imu.translation_clustered = imu.rotation_std = imu.rotation_clustered = none;
    imu.rotation_vector_std = imu.rotation_vector_clustered = none;
    imu.time_offset_std = imu.time_offset_clustered = unknown;
  }
}

vec3 meanOf(const std::vector<VarID<vec3>>& ids) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& id : ids) sum += *id / double(ids.size());
  return vec3(sum);
}

}  // namespace

CamerasStart startOf(const Result& cameras) {
  CamerasStart start;
  for (const CameraResult& camera : cameras.cameras) {
    start.lenses.push_back(lensOf(camera));
    start.rig.left2camera.push_back(camera.left2camera);
  }
  for (const ImageResult& image : cameras.images) start.rig.left2world[image.image] = image.left2world;
  return start;
}

StreamProblem::StreamProblem(const Dataset& data, const Settings& settings, const CamerasStart& cameras,
                             const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                             const std::vector<StartedImu>& imus, double gravity)
    : data_(data),
      settings_(settings),
      images_(images),
      gravity_(gravity),
      rig_(data, settings, cameras.lenses, cameras.rig, {}),
      est_(rig_.estimator()) {
  up_ = est_.insertRV(up, true, "up");
  for (const StartedImu& imu : imus) insert(imu);
}

void StreamProblem::insert(const StartedImu& started) {
  const std::string& name = started.stream->name;
  Imu& imu = imus_.emplace_back();
  imu.stream = started.stream;
  imu.noise = started.noise;
  imu.samples = ImuSamples(started.stream->samples);
  imu.left2imu = est_.insertRV(started.left2imu, true, name + ".pose");
  imu.offset = est_.insertRV(mtk::Scalar<>(started.start.offset), true, name + ".time_offset");
  insertIntervals(imu, started);
  insertWalk(imu, started.noise);
  if (imu.intervals.empty())
    throw DataError("slom.calibration.bad-stream",
                    {.place = nameOf(*started.stream),
                     .fault = "there are no readings between any two successive images",
                     .remedy = "give images and readings of the same motion"});
}

void StreamProblem::insertIntervals(Imu& imu, const StartedImu& started) {
  const std::string& name = started.stream->name;
  const std::vector<vec3> velocities = velocitiesOf(images_);
  imu.velocities.resize(images_.size());
  const auto velocity = [&](std::size_t i) {
    if (!imu.velocities[i].isValid())
      imu.velocities[i] =
          est_.insertRV(velocities[i], true, name + ".velocity[" + std::to_string(images_[i].image) + "]");
    return imu.velocities[i];
  };
  const auto gaps = gapsOf(*started.stream);
  const auto hasGap = [&](double from, double to) {
    return std::any_of(gaps.begin(), gaps.end(),
                       [&](const auto& gap) { return gap.first < to && gap.second > from; });
  };
  for (std::size_t i = 0; i + 1 < images_.size(); ++i) {
    const double from = images_[i].time, to = images_[i + 1].time, shift = started.start.offset;
    if (from + shift < imu.samples.begin() || to + shift > imu.samples.end() ||
        hasGap(from + shift, to + shift))
      continue;
    const PreintegratedImu moved(imu.samples, from + shift, to + shift, started.noise,
                                 started.start.gyro_bias);
    const std::string place = "[" + std::to_string(images_[i].image) + "]";
    imu.gyro_biases.push_back(est_.insertRV(started.start.gyro_bias, true, name + ".gyro_bias" + place));
    imu.force_biases.push_back(est_.insertRV(started.force_bias, true, name + ".acc_bias" + place));
    const auto id = est_.insertMeasurement(
        ImuBetweenImages(imu.samples, from, to, gravity_), rig_.poses().at(images_[i].image), velocity(i),
        imu.gyro_biases.back(), imu.force_biases.back(), rig_.poses().at(images_[i + 1].image),
        velocity(i + 1), imu.left2imu, imu.offset, up_, Covariance(moved.covariance()),
        group("image", images_[i].image));
    imu.intervals.push_back({i, to - from, moved.covariance(), id});
  }
}

void StreamProblem::insertWalk(Imu& imu, const ImuNoise& noise) {
  const auto step = [](const auto& before, const auto& after) { return after - before; };
  for (std::size_t k = 1; k < imu.intervals.size(); ++k) {
    const Interval &a = imu.intervals[k - 1], &b = imu.intervals[k];
    const double time = images_[b.first].time + b.duration / 2 - images_[a.first].time - a.duration / 2;
    const Group image = group("image", images_[b.first].image);
    est_.insertMeasurement(step, imu.gyro_biases[k - 1], imu.gyro_biases[k],
                           StandardDeviation(noise.gyro_walk * std::sqrt(time)), image);
    est_.insertMeasurement(step, imu.force_biases[k - 1], imu.force_biases[k],
                           StandardDeviation(noise.force_walk * std::sqrt(time)), image);
  }
}

std::vector<StartedImu> StreamProblem::restarted() const {
  std::vector<StartedImu> all;
  for (const Imu& imu : imus_) {
    StartedImu next{
        imu.stream, {double(*imu.offset), imu.left2imu->orient, meanOf(imu.gyro_biases)}, imu.noise};
    next.left2imu = *imu.left2imu;
    next.force_bias = meanOf(imu.force_biases);
    if (!imu.stream->noise) {
      const Ratios ratios = ratiosOf(imu);
      next.noise.gyro = std::max(least_density, next.noise.gyro * limited(ratios.gyro));
      next.noise.force = std::max(least_density, next.noise.force * limited(ratios.force));
    }
    all.push_back(next);
  }
  return all;
}

ImuStreamResult StreamProblem::resultOf(const Imu& imu) const {
  ImuStreamResult result;
  result.name = imu.stream->name;
  result.file = imu.stream->file;
  result.intervals = imu.intervals.size();
  const auto first = imu.samples.all().begin(), last = imu.samples.all().end();
  const double from = images_[imu.intervals.front().first].time + double(*imu.offset),
               to = images_[imu.intervals.back().first + 1].time + double(*imu.offset);
  result.samples = std::size_t(
      std::count_if(first, last, [&](const ImuSample& s) { return s.time >= from && s.time <= to; }));
  result.left2imu = *imu.left2imu;
  result.time_offset = double(*imu.offset);
  result.gyro_bias = meanOf(imu.gyro_biases);
  result.force_bias = meanOf(imu.force_biases);
  double gyro = 0, force = 0;
  for (const Interval& one : imu.intervals) {
    const Eigen::VectorXd r = est_.residual(one.id);
    gyro += r.head<3>().squaredNorm() / (one.duration * one.duration);
    force += r.segment<3>(3).squaredNorm() / (one.duration * one.duration);
  }
  result.rms_gyro = std::sqrt(gyro / double(imu.intervals.size()));
  result.rms_force = std::sqrt(force / double(imu.intervals.size()));
  result.noise = imu.noise;
  result.noise_is_given = imu.stream->noise.has_value();
  return result;
}

StreamResult StreamProblem::result(const Summary& summary) {
  StreamResult result;
  result.converged = summary.converged;
  result.stop_reason = toString(summary.stop_reason);
  result.message = summary.message;
  result.iterations = summary.iterations;
  result.unknowns = std::size_t(summary.unknowns);
  result.measurements = std::size_t(summary.measurements);
  result.gravity = vec3(up_->vector() * -gravity_);
  for (const Imu& imu : imus_) result.imus.push_back(resultOf(imu));
  try {
    addStandardDeviations(result);
    if (summary.converged && result.undetermined.empty()) addClustered(result);
  } catch (const slom::Error& error) {
    result.undetermined = sentenceOf(error);
  }
  if (!result.success()) forgetDeviations(result);
  return result;
}

void StreamProblem::addStandardDeviations(StreamResult& result) {
  result.gravity_direction_std = est_.standardDeviation(up_).maxCoeff();
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    ImuStreamResult& imu = result.imus[i];
    const Eigen::MatrixXd pose = est_.covariance(imus_[i].left2imu);
    if (result.undetermined.empty()) result.undetermined = openDirectionOf(imu.name, pose);
    imu.translation_std = vec3(pose.diagonal().head<3>().cwiseSqrt());
    imu.rotation_std = vec3(pose.diagonal().tail<3>().cwiseSqrt());
    imu.rotation_vector_std = rotationVectorStd(imu.left2imu.orient, pose.bottomRightCorner<3, 3>());
    imu.time_offset_std = est_.standardDeviation(imus_[i].offset)[0];
    const Ratios ratios = ratiosOf(imus_[i]);
    imu.gyro_ratio = ratios.gyro;
    imu.force_ratio = ratios.force;
  }
}

void StreamProblem::addClustered(StreamResult& result) {
  ClusterOptions options;
  options.by = {ClusterBy::blocks("image", blockLength(images_.size()))};
  options.ordered = true;
  const Clustered clustered = slom::clustered(est_, options);
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    ImuStreamResult& imu = result.imus[i];
    const Eigen::VectorXd pose = clustered.standardDeviation(imus_[i].left2imu);
    imu.translation_clustered = vec3(pose.head<3>());
    imu.rotation_clustered = vec3(pose.tail<3>());
    imu.rotation_vector_clustered = rotationVectorStd(
        imu.left2imu.orient, clustered.covariance(imus_[i].left2imu).bottomRightCorner<3, 3>());
    imu.time_offset_clustered = clustered.standardDeviation(imus_[i].offset)[0];
  }
}

}  // namespace slom::calibration
