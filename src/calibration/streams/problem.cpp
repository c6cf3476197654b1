#include "calibration/streams/problem.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "calibration/fit/lens_constraints.hpp"
#include "calibration/fit/rig.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/models/lens.hpp"
#include "calibration/streams/bias_jumps.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/determined.hpp"
#include "calibration/streams/excitation.hpp"
#include "calibration/streams/mean_bias.hpp"
#include "calibration/streams/rest.hpp"
#include "slom/calibration/error.hpp"
#include "slom/measurements/gaussian_prior.hpp"

namespace slom::calibration {
namespace {

/// Returns the number of successive images in a group of errors that may depend on each other: about 48 groups, enough to
/// join neighbours until the variance no longer grows.
std::int64_t blockLength(std::size_t images) {
  constexpr std::size_t groups = 48;
  return std::int64_t(std::max<std::size_t>(1, images / groups));
}

constexpr double least_density = 1e-7;  ///< of noise that is estimated

vec3 valueAt(const std::map<std::size_t, vec3>& known, std::size_t i, const vec3& otherwise) {
  const auto found = known.find(i);
  return found == known.end() ? otherwise : found->second;
}

}  // namespace

StreamProblem::StreamProblem(const Dataset& data, const CondensedCorners& corners, const Settings& settings,
                             const CamerasAt& cameras, const std::vector<RigAtImage>& images,
                             const mtk::S2<>& up, const std::vector<StartedImu>& imus, double gravity,
                             const Loss& loss)
    : settings_(settings), images_(images), gravity_(gravity), loss_(loss) {
  insertCameras(data, cameras);
  setCorners(corners);
  up_ = est_.insertRV(up, true, "up");
  board_scale_ = est_.insertRV(mtk::Scalar<>(1), false, "board_scale");
  for (const StartedImu& imu : imus) insert(imu);
}

void StreamProblem::insertCameras(const Dataset& data, const CamerasAt& cameras) {
  const std::string reference = data.cameras.front().name;
  for (std::size_t c = 0; c < cameras.lenses.size(); ++c) {
    const std::string& name = data.cameras[c].name;
    lenses_.push_back(est_.insertRV(constrained(cameras.lenses[c], name, settings_), true, name));
    constrain(est_, lenses_.back(), name, settings_);
    if (settings_.sigma_denominator) addPrior(est_, lenses_.back(), *settings_.sigma_denominator);
    left2camera_.push_back(c == 0 ? VarID<SE3>()
                                  : est_.insertRV(cameras.rig.left2camera[c], true, reference + "2" + name));
  }
  for (const auto& [image, pose] : cameras.rig.left2world) {
    left2world_.emplace(image,
                        est_.insertRV(pose, true, reference + "2world[" + std::to_string(image) + "]"));
  }
}

void StreamProblem::setCorners(const CondensedCorners& all) {
  for (const auto& [image, seen] : seen_) est_.removeMeasurement(seen.id);
  corners_ = all.corners;
  const CamerasAt& point = all.point;
  for (const auto& [image, corners] : all.images) {
    Seen seen{{left2world_.at(image)}, corners.R / settings_.sigma_px, {}};
    for (const std::size_t c : corners.cameras) seen.variables.push_back(lenses_[c]);
    for (const std::size_t c : corners.cameras) {
      if (c > 0) seen.variables.push_back(left2camera_[c]);
    }
    GaussianPrior prior(seen.variables, seen.R, corners.b / settings_.sigma_px);
    prior.linearizedAt(left2world_.at(image), point.rig.left2world.at(image));
    for (const std::size_t c : corners.cameras) {
      prior.linearizedAt(lenses_[c], point.lenses[c]);
      if (c > 0) prior.linearizedAt(left2camera_[c], point.rig.left2camera[c]);
    }
    seen.id = est_.insertMeasurement(std::move(prior), group("image", image));
    seen_[image] = std::move(seen);
  }
}

Summary StreamProblem::optimize(const Options& options) {
  Summary summary = est_.optimize(options);
  nameLimit(settings_.limits, summary);
  return summary;
}

CamerasAt StreamProblem::cameras() const {
  CamerasAt now;
  for (const auto& id : lenses_) now.lenses.push_back(*id);
  for (std::size_t c = 0; c < left2camera_.size(); ++c)
    now.rig.left2camera.push_back(c == 0 ? SE3() : *left2camera_[c]);
  for (const auto& [image, id] : left2world_) now.rig.left2world[image] = *id;
  return now;
}

void StreamProblem::insert(const StartedImu& started) {
  const std::string& name = started.stream->name;
  Imu& imu = imus_.emplace_back();
  imu.stream = started.stream;
  imu.noise = started.noise;
  imu.jumps = started.jumps;
  imu.samples = ImuSamples(started.stream->samples);
  imu.left2imu = est_.insertRV(started.left2imu, true, name + ".pose");
  imu.offset = est_.insertRV(mtk::Scalar<>(started.start.offset), true, name + ".time_offset");
  imu.axes.insert(est_, started.axes, started.model, name);
  insertIntervals(imu, started);
  insertWalk(imu, started.noise);
  if (imu.intervals.empty())
    throw DataError("slom.calibration.bad-stream",
                    {.place = nameOf(*started.stream),
                     .fault = "there are no readings between any two successive images",
                     .remedy = "give images and readings of the same motion"});
}

ImuModel<> StreamProblem::modelOf(const Imu& imu) {
  return imu.axes.modelWith(meanBias(imu.gyro_biases), meanBias(imu.force_biases));
}

void StreamProblem::insertIntervals(Imu& imu, const StartedImu& started) {
  const std::string& name = started.stream->name;
  const std::vector<vec3> velocities = velocitiesOf(images_);
  imu.velocities.resize(images_.size());
  const auto velocity = [&](std::size_t i) {
    if (!imu.velocities[i].isValid())
      imu.velocities[i] = est_.insertRV(valueAt(started.velocities, i, velocities[i]), true,
                                        name + ".velocity[" + std::to_string(images_[i].image) + "]");
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
    const vec3 gyro_bias = valueAt(started.gyro_biases, i, started.start.gyro_bias),
               force_bias = valueAt(started.force_biases, i, started.force_bias);
    const PreintegratedImu moved(imu.samples, from + shift, to + shift, started.noise, gyro_bias, force_bias);
    const std::string place = "[" + std::to_string(images_[i].image) + "]";
    imu.gyro_biases.push_back(est_.insertRV(gyro_bias, true, name + ".gyro_bias" + place));
    imu.force_biases.push_back(est_.insertRV(force_bias, true, name + ".acc_bias" + place));
    const AnyMeasID id = imu.axes.with([&](const auto&... axes) -> AnyMeasID {
      return est_.insertMeasurement(ImuBetweenImages(imu.samples, from, to, gravity_),
                                    left2world_.at(images_[i].image), velocity(i), imu.gyro_biases.back(),
                                    imu.force_biases.back(), left2world_.at(images_[i + 1].image),
                                    velocity(i + 1), imu.left2imu, imu.offset, up_, board_scale_, axes...,
                                    Covariance(moved.covariance()), group("image", images_[i].image), loss_);
    });
    imu.intervals.push_back({i, to - from, moved.covariance(), id});
  }
}

void StreamProblem::insertWalk(Imu& imu, const ImuNoise& noise) {
  const auto step = [](const auto& before, const auto& after) { return after - before; };
  for (std::size_t k = 1; k < imu.intervals.size(); ++k) {
    const Interval& b = imu.intervals[k];
    const double to = images_[b.first].time + b.duration / 2 + double(*imu.offset),
                 from = to - timeBetween(imu, k);
    const Group image = group("image", images_[b.first].image);
    const auto insert = [&](const std::vector<VarID<vec3>>& biases, bool is_gyro, double density) {
      est_.insertMeasurement(step, biases[k - 1], biases[k],
                             StandardDeviation(incrementDeviation(imu.jumps, is_gyro, density, from, to)),
                             image);
    };
    insert(imu.gyro_biases, true, noise.gyro_walk);
    insert(imu.force_biases, false, noise.force_walk);
  }
}

std::vector<StartedImu> StreamProblem::started() const {
  std::vector<StartedImu> all;
  for (const Imu& imu : imus_) {
    StartedImu next{
        imu.stream, {double(*imu.offset), imu.left2imu->orient, meanBias(imu.gyro_biases)}, imu.noise};
    next.left2imu = *imu.left2imu;
    next.force_bias = meanBias(imu.force_biases);
    next.axes = imu.axes.estimated;
    next.model = modelOf(imu);
    next.jumps = imu.jumps;
    for (std::size_t i = 0; i < imu.velocities.size(); ++i) {
      if (imu.velocities[i].isValid()) next.velocities.emplace(i, *imu.velocities[i]);
    }
    for (std::size_t k = 0; k < imu.intervals.size(); ++k) {
      next.gyro_biases.emplace(imu.intervals[k].first, *imu.gyro_biases[k]);
      next.force_biases.emplace(imu.intervals[k].first, *imu.force_biases[k]);
    }
    all.push_back(next);
  }
  return all;
}

std::vector<StartedImu> StreamProblem::restarted() const {
  std::vector<StartedImu> all = started();
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    if (imus_[i].stream->noise) continue;
    const Ratios ratios = ratiosOf(imus_[i]);
    ImuNoise& noise = all[i].noise;
    noise.gyro = std::max(least_density, noise.gyro * limited(ratios.gyro));
    noise.force = std::max(least_density, noise.force * limited(ratios.force));
  }
  return all;
}

std::vector<std::vector<GrossReadings>> StreamProblem::grossReadings() const {
  constexpr double much = 10;
  constexpr double components = 9;  // of a residual
  std::vector<std::vector<GrossReadings>> all;
  for (const Imu& imu : imus_) {
    std::vector<double> lengths;
    for (const Interval& one : imu.intervals) lengths.push_back(est_.whitenedResidual(one.id).norm());
    const double usual = std::max(medianOf(lengths), std::sqrt(components));
    std::vector<GrossReadings>& gross = all.emplace_back();
    for (std::size_t k = 0; k < lengths.size(); ++k) {
      const double from = images_[imu.intervals[k].first].time + double(*imu.offset);
      if (lengths[k] > much * usual)
        gross.push_back({from, from + imu.intervals[k].duration, lengths[k] / usual});
    }
    if (10 * gross.size() > lengths.size()) gross.clear();
  }
  return all;
}

std::vector<VarID<vec3>> StreamProblem::biasesBeforeJumps(const Imu& imu, bool is_gyro) const {
  const std::vector<VarID<vec3>>& all = is_gyro ? imu.gyro_biases : imu.force_biases;
  const double jump = firstJump(imu.jumps, is_gyro);
  std::vector<VarID<vec3>> before;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Interval& one = imu.intervals[k];
    if (images_[one.first].time + one.duration / 2 + double(*imu.offset) < jump) before.push_back(all[k]);
  }
  return before.empty() ? all : before;
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
  std::vector<double> spacings;
  for (auto next = first + 1; next < last; ++next) spacings.push_back(next->time - (next - 1)->time);
  result.rate = 1 / medianOf(spacings);
  result.left2imu = *imu.left2imu;
  result.time_offset = double(*imu.offset);
  result.gyro_bias = meanBias(biasesBeforeJumps(imu, true));
  result.force_bias = meanBias(biasesBeforeJumps(imu, false));
  result.axes.estimated = imu.axes.estimated;
  result.axes.model = modelOf(imu);
  double gyro = 0, force = 0;
  for (const Interval& one : imu.intervals) {
    const Eigen::VectorXd r = est_.residual(one.id) / one.duration;
    gyro += r.head<3>().squaredNorm();
    force += r.segment<3>(3).squaredNorm();
    const Eigen::Matrix<double, 9, 1> variances = one.noise.diagonal() / (one.duration * one.duration);
    result.residuals.push_back({images_[one.first].time, one.duration, vec3(-r.head<3>()),
                                vec3(-r.segment<3>(3)), std::sqrt(variances.head<3>().mean()),
                                std::sqrt(variances.segment<3>(3).mean())});
  }
  result.rms_gyro = std::sqrt(gyro / double(imu.intervals.size()));
  result.rms_force = std::sqrt(force / double(imu.intervals.size()));
  addRest(*imu.stream, result);
  result.noise = imu.noise;
  result.noise_is_given = imu.stream->noise.has_value();
  result.excitation = excitationOf(*imu.stream, images_, result);
  return result;
}

StreamResult StreamProblem::result(const Summary& summary) {
  StreamResult result = endOf(summary);
  result.measurements += 2 * corners_;
  for (const auto& [image, seen] : seen_) result.measurements -= std::size_t(seen.R.rows());
  result.gravity = vec3(up_->vector() * -gravity_);
  for (const Imu& imu : imus_) result.imus.push_back(resultOf(imu));
  for (const RigAtImage& image : images_) result.poses.push_back({image.time, *left2world_.at(image.image)});
  addDeviations([&] { addStandardDeviations(result); }, [&] { addClustered(result); }, result);
  return result;
}

std::vector<ImuStreamResult> StreamProblem::posesOfImus() const {
  std::vector<ImuStreamResult> all;
  for (const Imu& imu : imus_) {
    ImuStreamResult& one = all.emplace_back();
    one.left2imu = *imu.left2imu;
    one.time_offset = double(*imu.offset);
    one.time_offset_std = est_.standardDeviation(imu.offset)[0];
    setPoseDeviations(est_.covariance(imu.left2imu), one);
  }
  return all;
}

std::vector<ImuStreamResult> StreamProblem::posesAndRatios() const {
  std::vector<ImuStreamResult> all = posesOfImus();
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    all[i].noise = imus_[i].noise;
    all[i].noise_is_given = imus_[i].stream->noise.has_value();
    const Ratios ratios = ratiosOf(imus_[i]);
    all[i].gyro_ratio = ratios.gyro;
    all[i].force_ratio = ratios.force;
  }
  return all;
}

bool StreamProblem::hasErrorOfAxes(std::size_t imu, double deviations) const {
  const AxesVariables& axes = imus_[imu].axes;
  const auto exceeds = [&](const auto& id, const Eigen::VectorXd& std) {
    return (id->cwiseAbs().array() > deviations * std.array()).any();
  };
  std::optional<Clustered> clustered;
  const auto is_off = [&](const auto& id) {
    if (!exceeds(id, est_.standardDeviation(id))) return false;
    if (!clustered) clustered = byBlocks();
    return exceeds(id, est_.standardDeviation(id).cwiseMax(clustered->standardDeviation(id)));
  };
  return axes.exist() && (is_off(axes.gyro_axes) || is_off(axes.force_axes) || is_off(axes.gyro_by_force));
}

void StreamProblem::addStandardDeviations(StreamResult& result) {
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

Clustered StreamProblem::byBlocks() const {
  ClusterOptions options;
  options.by = {ClusterBy::blocks("image", blockLength(images_.size()))};
  options.ordered = true;
  return slom::clustered(est_, options);
}

void StreamProblem::addClustered(StreamResult& result) {
  const Clustered clustered = byBlocks();
  result.gravity_direction_clustered = clustered.standardDeviation(up_).maxCoeff();
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
