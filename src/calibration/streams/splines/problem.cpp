#include "calibration/streams/splines/problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "calibration/fit/lens_constraints.hpp"
#include "calibration/limits.hpp"
#include "calibration/streams/mean_bias.hpp"
#include "calibration/streams/splines/place_view.hpp"

namespace slom::calibration {
namespace {

constexpr int bias_order = 2;

/// Returns the pose between two images: positions and rotations change linearly.
SE3 between(const RigAtImage& a, const SE3& pose_a, const RigAtImage& b, const SE3& pose_b, double time) {
  const double along = b.time > a.time ? std::clamp((time - a.time) / (b.time - a.time), 0., 1.) : 0;
  return SE3(pose_a.orient * SO3::exp(vec3(along * SO3::log(pose_a.orient.inverse() * pose_b.orient))),
             vec3(pose_a.pos + along * (pose_b.pos - pose_a.pos)));
}

/// Returns start values of control points from the poses at the images of a stretch.
std::function<SE3(double)> byImages(const SplineRecording& recording, const Stretch& stretch,
                                    const RigStart& rig) {
  return [&recording, &stretch, &rig](double time) {
    const auto image = [&](std::size_t i) -> const RigAtImage& {
      return recording.images[stretch.images[i]];
    };
    const auto next = std::partition_point(stretch.images.begin() + 1, stretch.images.end() - 1,
                                           [&](std::size_t i) { return recording.images[i].time < time; });
    const std::size_t b = std::size_t(next - stretch.images.begin());
    return between(image(b - 1), rig.left2world.at(image(b - 1).image), image(b),
                   rig.left2world.at(image(b).image), time);
  };
}

/// Returns the control points of a spline as a function of their times.
template <class Spline>
std::function<typename Spline::Control(double)> controlsOf(const Spline& spline, int order) {
  using Control = typename Spline::Control;
  const std::int64_t first = spline.knots().segmentAt(spline.firstTime());
  const auto controls = std::make_shared<std::map<double, Control>>();
  for (std::size_t k = 0; k < spline.controls().size(); ++k)
    controls->emplace(spline.knots().timeOfControl(first + std::int64_t(k), order), *spline.controls()[k]);
  return [controls](double time) -> Control {
    const auto next = controls->lower_bound(time);
    if (next == controls->begin()) return next->second;
    const auto before = std::prev(next);
    return next == controls->end() || time - before->first < next->first - time ? before->second
                                                                                : next->second;
  };
}

}  // namespace

SplineProblem::SplineProblem(const SplineRecording& recording, const SplineValues& values)
    : recording_(recording),
      start_(values),
      stretch_of_(recording.images.size()),
      left2world_(recording.images.size()) {
  up_ = est_.insertRV(values.up, true, "up");
  board_scale_ = est_.insertRV(mtk::Scalar<>(1), false, "board_scale");
  insertCameras();
  insertTimings();
  for (std::size_t i = 0; i < recording.images.size(); ++i) index_of_.emplace(recording.images[i].image, i);
  for (std::size_t s = 0; s < recording.stretches.size(); ++s) {
    const Stretch& stretch = recording.stretches[s];
    for (const std::size_t i : stretch.images) stretch_of_[i] = s;
    insertStretch(stretch,
                  values.poses.empty() ? byImages(recording, stretch, values.cameras.rig) : values.poses[s]);
  }
  insertViews();
  for (const StartedImu& imu : values.imus) insert(imu);
  for (RigSpline& spline : splines_) spline.tieEnds(est_);
}

void SplineProblem::insertCameras() {
  const auto& cameras = recording_.data.cameras;
  const Settings& settings = recording_.settings;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const std::string& name = cameras[c].name;
    lenses_.push_back(est_.insertRV(constrained(start_.cameras.lenses[c], name, settings), true, name));
    constrain(est_, lenses_.back(), name, settings);
    if (settings.sigma_denominator) addPrior(est_, lenses_.back(), *settings.sigma_denominator);
    left2camera_.push_back(
        c == 0 ? VarID<SE3>()
               : est_.insertRV(start_.cameras.rig.left2camera[c], true, cameras.front().name + "2" + name));
  }
}

void SplineProblem::insertTimings() {
  for (std::size_t c = 0; c < recording_.clocks.size(); ++c) {
    const CameraClock& clock = recording_.clocks[c];
    const CameraTiming& at = start_.timings[c];
    const std::string& name = recording_.data.cameras[c].name;
    timings_.push_back(
        {est_.insertRV(mtk::Scalar<>(at.offset), clock.is_offset_estimated, name + ".time_offset"),
         est_.insertRV(mtk::Scalar<>(at.line_delay), clock.is_line_delay_estimated, name + ".line_delay")});
  }
}

void SplineProblem::insertStretch(const Stretch& stretch, const std::function<SE3(double)>& start) {
  // Images and readings of one clock would often be at knots, and move from one segment to the next and back.
  constexpr double phase = 0.137;
  splines_.emplace_back(
      trajectory::Knots(stretch.from - phase * recording_.knot_spacing, recording_.knot_spacing),
      "pose" + (recording_.stretches.size() > 1 ? std::to_string(splines_.size()) : ""));
  splines_.back().extend(est_, stretch.from, stretch.to, start);
}

Group SplineProblem::timeGroup(double time) const {
  return group("time", std::int64_t(std::floor(1000 * time)));
}

void SplineProblem::insertViews() {
  const bool are_moving = !timings_.empty();
  for (std::size_t i = 0; i < recording_.images.size() && !are_moving; ++i) {
    if (!stretch_of_[i])
      left2world_[i] = est_.insertRV(start_.cameras.rig.left2world.at(recording_.images[i].image), true,
                                     "pose at image " + std::to_string(recording_.images[i].image));
  }
  for (std::size_t c = 0; c < lenses_.size(); ++c) {
    LensRows rows(*lenses_[c]);
    for (const View& view : recording_.data.cameras[c].views)
      are_moving ? insertMovingView(c, view, rows) : insertView(c, view, rows);
    est_.insertMeasurement(RowsOfLens(std::make_shared<LensRows>(std::move(rows))), lenses_[c],
                           StandardDeviation(start_.sigma_px), named("lens"));
  }
}

void SplineProblem::insertView(std::size_t camera, const View& view, LensRows& rows) {
  const auto found = index_of_.find(view.image);
  if (found == index_of_.end()) return;
  const std::size_t image = found->second;
  const double image_time = recording_.images[image].time;
  const auto condensed_view = std::make_shared<CondensedView>(
      condensed(view, *lenses_[camera], camera == 0 ? SE3() : *left2camera_[camera], poseAt(image), rows));
  const Group time = timeGroup(image_time);
  if (!stretch_of_[image]) {
    const ViewAtPose at_pose(condensed_view);
    const VarID<SE3>& pose = left2world_[image];
    const StandardDeviation sigma(start_.sigma_px);
    views_.push_back(
        camera == 0
            ? AnyMeasID(est_.insertMeasurement(at_pose, pose, lenses_[camera], sigma, time, named("corners")))
            : est_.insertMeasurement(at_pose, pose, lenses_[camera], left2camera_[camera], sigma, time,
                                     named("corners")));
    return;
  }
  const std::size_t stretch = *stretch_of_[image];
  const RigSpline& spline = splines_[stretch];
  const auto [segment, first] = controlsAt(spline, image_time);
  const ViewOnSpline on_spline(condensed_view, PoseOnSegment({spline.knots(), segment}, image_time));
  const std::pair lens(lenses_[camera], true);
  camera == 0 ? place(on_spline, stretch, first, time, lens)
              : place(on_spline, stretch, first, time, lens, std::pair(left2camera_[camera], true));
}

SE3 SplineProblem::poseAt(std::size_t image) const {
  const double time = recording_.images[image].time;
  return stretch_of_[image] ? splines_[*stretch_of_[image]].segmentAt(time).poseAt(time)
                            : *left2world_[image];
}

Summary SplineProblem::optimize(const Options& options) {
  Summary summary = trajectory::optimize(
      est_, std::vector<trajectory::SplineBase>(splines_.begin(), splines_.end()), options);
  nameLimit(recording_.settings.limits, summary);
  return summary;
}

SplineValues SplineProblem::values() const {
  SplineValues now = start_;
  now.up = *up_;
  now.poses.clear(), now.biases.clear();
  for (std::size_t c = 0; c < lenses_.size(); ++c) {
    now.cameras.lenses[c] = *lenses_[c];
    if (c > 0) now.cameras.rig.left2camera[c] = *left2camera_[c];
  }
  for (std::size_t i = 0; i < recording_.images.size(); ++i) {
    if (hasPose(i)) now.cameras.rig.left2world[recording_.images[i].image] = poseAt(i);
  }
  for (std::size_t c = 0; c < timings_.size(); ++c)
    now.timings[c] = {double(*timings_[c].offset), double(*timings_[c].line_delay)};
  for (std::size_t k = 0; k < imus_.size(); ++k) {
    const Imu& imu = imus_[k];
    StartedImu& next = now.imus[k];
    next.start = {double(*imu.offset), imu.left2imu->orient, meanBias(imu.gyro_bias.controls())};
    next.left2imu = *imu.left2imu;
    next.force_bias = meanBias(imu.force_bias.controls());
    next.model = modelOf(imu);
    now.biases.push_back({controlsOf(imu.gyro_bias, bias_order), controlsOf(imu.force_bias, bias_order)});
  }
  for (const RigSpline& spline : splines_) now.poses.push_back(controlsOf(spline, pose_order));
  return now;
}

}  // namespace slom::calibration
