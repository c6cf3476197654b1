// Values and standard deviations of a fit by splines.
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/fit/rig.hpp"
#include "calibration/streams/determined.hpp"
#include "calibration/streams/excitation.hpp"
#include "calibration/streams/mean_bias.hpp"
#include "calibration/streams/rest.hpp"
#include "calibration/streams/splines/problem.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {

StreamResult SplineProblem::result(const Summary& summary) {
  StreamResult result = endOf(summary);
  result.path = StreamPath::splines;
  result.sigma_px = start_.sigma_px;
  result.gravity = vec3(up_->vector() * -recording_.gravity);
  for (const Imu& imu : imus_) result.imus.push_back(resultOf(imu));
  addTimings(result);
  for (std::size_t i = 0; i < recording_.images.size(); ++i) {
    if (hasPose(i)) result.poses.push_back({recording_.images[i].time, poseAt(i)});
  }
  addDeviations([&] { addStandardDeviations(result); }, [&] { addClustered(result); }, result);
  return result;
}

ImuStreamResult SplineProblem::resultOf(const Imu& imu) const {
  ImuStreamResult result;
  result.name = imu.stream->name;
  result.file = imu.stream->file;
  result.samples = imu.readings.size();
  result.left2imu = *imu.left2imu;
  result.time_offset = double(*imu.offset);
  result.gyro_bias = meanBias(biasesBeforeJumps(imu, true));
  result.force_bias = meanBias(biasesBeforeJumps(imu, false));
  result.noise = imu.noise;
  result.noise_is_given = imu.stream->noise.has_value();
  addMeanResiduals(imu, result);
  result.rate = imu.rate;
  result.axes.estimated = imu.axes.estimated;
  result.axes.model = modelOf(imu);
  result.excitation = excitationOf(*imu.stream, recording_.images, result);
  addRest(*imu.stream, result);
  return result;
}

/// Sets the root mean squares of the residuals, each a mean between two successive images, and the number of such pairs.
void SplineProblem::addMeanResiduals(const Imu& imu, ImuStreamResult& result) const {
  const auto& images = recording_.images;
  double gyro = 0, force = 0;
  std::size_t next = 0;
  for (std::size_t i = 1; i < images.size(); ++i) {
    Eigen::Vector3d gyro_sum = Eigen::Vector3d::Zero(), force_sum = gyro_sum;
    double count = 0;
    for (; next < imu.readings.size(); ++next) {
      const Reading& reading = imu.readings[next];
      const double time = reading.sample->time - double(*imu.offset);
      if (time > images[i].time) break;
      gyro_sum += est_.residual(reading.gyro.id());
      force_sum += est_.residual(reading.force.id());
      ++count;
    }
    if (count == 0) continue;
    gyro += gyro_sum.squaredNorm() / (count * count);
    force += force_sum.squaredNorm() / (count * count);
    const double std = std::sqrt(imu.rate / count);  // of a mean, for white noise of density 1
    result.residuals.push_back({images[i - 1].time, images[i].time - images[i - 1].time,
                                vec3(-gyro_sum / count), vec3(-force_sum / count), imu.noise.gyro * std,
                                imu.noise.force * std});
    ++result.intervals;
  }
  result.rms_gyro = std::sqrt(gyro / double(result.intervals));
  result.rms_force = std::sqrt(force / double(result.intervals));
}

void SplineProblem::addTimings(StreamResult& result) const {
  for (std::size_t c = 0; c < timings_.size(); ++c) {
    CameraStreamResult camera;
    camera.name = recording_.data.cameras[c].name;
    if (c > 0) camera.left2camera = *left2camera_[c];
    if (recording_.clocks[c].is_offset_estimated) camera.time_offset = {double(*timings_[c].offset)};
    if (recording_.clocks[c].is_line_delay_estimated) camera.line_delay = {double(*timings_[c].line_delay)};
    result.cameras.push_back(std::move(camera));
  }
}

/// Calls each(value, id) for the values of a camera's timing that are estimated.
void SplineProblem::eachTiming(StreamResult& result, const auto& each) const {
  for (std::size_t c = 0; c < timings_.size(); ++c) {
    CameraStreamResult& camera = result.cameras[c];
    if (camera.time_offset) each(*camera.time_offset, timings_[c].offset);
    if (camera.line_delay) each(*camera.line_delay, timings_[c].line_delay);
  }
}

void SplineProblem::addStandardDeviations(StreamResult& result) {
  for (std::size_t c = 1; c < timings_.size(); ++c) {
    const Eigen::VectorXd std = est_.standardDeviation(left2camera_[c]);
    result.cameras[c].translation_std = vec3(std.head<3>());
    result.cameras[c].rotation_std = vec3(std.tail<3>());
  }
  eachTiming(result,
             [&](StreamNumber& number, const auto& id) { number.std = est_.standardDeviation(id)[0]; });
  for (const CameraStreamResult& camera : result.cameras) {
    if (result.undetermined.empty()) result.undetermined = openTimingOf(camera);
  }
  result.gravity_direction_std = est_.standardDeviation(up_).maxCoeff();
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    ImuStreamResult& imu = result.imus[i];
    const Eigen::MatrixXd pose = est_.covariance(imus_[i].left2imu);
    if (result.undetermined.empty()) result.undetermined = openDirectionOf(imu.name, pose);
    setPoseDeviations(pose, imu);
    imu.time_offset_std = est_.standardDeviation(imus_[i].offset)[0];
    imu.axes.std = imus_[i].axes.ofEach([&](const auto& id) { return est_.standardDeviation(id); });
    setBiasDeviations(est_, biasesBeforeJumps(imus_[i], true), biasesBeforeJumps(imus_[i], false), imu);
    for (std::string& sentence : uncertainOf(imu, pose)) result.notes.push_back(std::move(sentence));
    const Ratios ratios = ratiosOf(imus_[i]);
    imu.gyro_ratio = ratios.gyro;
    imu.force_ratio = ratios.force;
  }
}

Clustered SplineProblem::byBlocks() const {
  constexpr double blocks = 48;  // enough to join neighbours until the variance no longer grows
  const auto& images = recording_.images;
  const auto length = std::int64_t(std::ceil(1000 * (images.back().time - images.front().time) / blocks));
  ClusterOptions options;
  options.by = {ClusterBy::blocks("time", std::max<std::int64_t>(1, length))};
  options.ordered = true;
  return slom::clustered(est_, options);
}

void SplineProblem::addClustered(StreamResult& result) {
  const Clustered clustered = byBlocks();
  result.gravity_direction_clustered = clustered.standardDeviation(up_).maxCoeff();
  for (std::size_t c = 1; c < timings_.size(); ++c) {
    const Eigen::VectorXd std = clustered.standardDeviation(left2camera_[c]);
    result.cameras[c].translation_clustered = vec3(std.head<3>());
    result.cameras[c].rotation_clustered = vec3(std.tail<3>());
  }
  eachTiming(result, [&](StreamNumber& number, const auto& id) {
    number.std_clustered = clustered.standardDeviation(id)[0];
  });
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    ImuStreamResult& imu = result.imus[i];
    setClusteredDeviations(clustered.covariance(imus_[i].left2imu), imu);
    imu.axes.std_clustered =
        imus_[i].axes.ofEach([&](const auto& id) { return clustered.standardDeviation(id); });
    setBiasDeviations(est_, clustered, biasesBeforeJumps(imus_[i], true), biasesBeforeJumps(imus_[i], false),
                      imu);
    imu.time_offset_clustered = clustered.standardDeviation(imus_[i].offset)[0];
  }
}

}  // namespace slom::calibration
