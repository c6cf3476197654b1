#include "slom/calibration/moving_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/image_box.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/fit/rig.hpp"
#include "calibration/median.hpp"
#include "calibration/procedure/fit_once.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/forces.hpp"
#include "calibration/streams/held_axes.hpp"
#include "calibration/streams/joint_fit.hpp"
#include "calibration/streams/preparation.hpp"
#include "calibration/streams/splines/fit.hpp"
#include "calibration/streams/usable_streams.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double seconds = 1e-9;  ///< of a nanosecond

/// The cameras, each image with a number of its own: of one camera, numbers are equal steps of time.
struct Apart {
  Dataset data;
  std::map<int, int> given_number;  ///< of the first camera's images
  int largest_given = 0;            ///< number of any image
  std::vector<double> interval;     ///< of successive numbers, by camera [s]
};

/// Numbers the images of a camera from `first` on.
void numberByTime(CameraData& camera, int first, double& interval) {
  std::sort(camera.views.begin(), camera.views.end(),
            [](const View& a, const View& b) { return *a.time_ns < *b.time_ns; });
  std::vector<double> gaps;
  for (std::size_t i = 1; i < camera.views.size(); ++i)
    gaps.push_back(double(*camera.views[i].time_ns - *camera.views[i - 1].time_ns) * seconds);
  interval = medianOf(gaps);
  int last = first - 1;
  for (View& view : camera.views) {
    const double steps = double(*view.time_ns - *camera.views.front().time_ns) * seconds / interval;
    last = std::max(last + 1, first + int(std::llround(std::min(steps, 1e8))));
    view.image = last;
  }
}

Apart apartOf(const Dataset& data) {
  Apart apart{data, {}, 0, {}};
  apart.data.imu.reset();
  int first = 1;
  for (CameraData& camera : apart.data.cameras) {
    std::map<std::int64_t, int> given;
    for (const View& view : camera.views) {
      requireTime(camera, view);
      given.emplace(*view.time_ns, view.image);
      apart.largest_given = std::max(apart.largest_given, view.image);
    }
    numberByTime(camera, first, apart.interval.emplace_back());
    for (const View& view : camera.views) {
      if (apart.interval.size() == 1) apart.given_number.emplace(view.image, given.at(*view.time_ns));
      first = std::max(first, view.image + 1);
    }
  }
  return apart;
}

Settings settingsOf(const CameraData& camera, const Settings& given) {
  Settings settings = given;
  settings.fixed = {};
  std::erase_if(settings.lens,
                [&](const LensConstraint& one) { return !one.camera.empty() && one.camera != camera.name; });
  return settings;
}

/// One camera by its own images: the result, and the data without what it rejected, with its noise.
struct Alone {
  Result result;
  Dataset data;
  std::int64_t epoch_ns = 0;       ///< of its first image
  std::vector<RigAtImage> images;  ///< poses of the camera, times from the epoch on
};

Alone calibrateAlone(const CameraData& camera, const Settings& given) {
  Alone alone;
  alone.data.cameras = {camera};
  alone.result = fitOnce(alone.data, settingsOf(camera, given));
  if (!alone.result.success())
    throw DataError(
        "slom.calibration.no-result",
        {.place = nameOf(camera),
         .fault = "the images of this camera do not calibrate it: " +
                  (alone.result.undetermined.empty() ? alone.result.message : alone.result.undetermined),
         .remedy = "take more images, or give its lens"});
  std::map<int, std::int64_t> times;
  for (const View& view : camera.views) times.emplace(view.image, *view.time_ns);
  alone.epoch_ns = *camera.views.front().time_ns;
  for (const ImageResult& image : alone.result.images) {
    const auto time = times.find(image.image);
    if (time != times.end())
      alone.images.push_back(
          {image.image, double(time->second - alone.epoch_ns) * seconds, image.left2world});
  }
  alone.data = withNoiseOf(alone.result, withoutRejected(alone.data, alone.result));
  return alone;
}

/// Returns the cameras by their own images, and their data together.
std::pair<std::vector<Alone>, Dataset> calibrateEach(const Apart& apart, const Settings& given) {
  std::pair<std::vector<Alone>, Dataset> each;
  for (const CameraData& camera : apart.data.cameras) {
    each.first.push_back(calibrateAlone(camera, given));
    each.second.cameras.push_back(each.first.back().data.cameras.front());
  }
  return each;
}

/// Returns the pose of a camera at a time between two images; nothing if they are far apart.
std::optional<SE3> poseAt(const std::vector<RigAtImage>& images, double time) {
  constexpr double longest = 0.3;  // s
  const auto next = std::lower_bound(images.begin(), images.end(), time,
                                     [](const RigAtImage& image, double t) { return image.time < t; });
  if (next == images.begin() || next == images.end()) return {};
  const RigAtImage &a = *std::prev(next), &b = *next;
  if (b.time - a.time > longest) return {};
  const double along = (time - a.time) / (b.time - a.time);
  const SO3& turn = a.left2world.orient;
  return SE3(turn * SO3::exp(vec3(along * SO3::log(turn.inverse() * b.left2world.orient))),
             vec3(a.left2world.pos + along * (b.left2world.pos - a.left2world.pos)));
}

/// Returns the pose of a camera on the rig: medians over its images of what both cameras' poses say. `near`: its rotation
/// from the angular velocities. `offset`: t_camera - t_reference, from their epochs on.
SE3 poseOnRig(const Alone& reference, const Alone& camera, const SO3& near, double offset) {
  std::vector<double> numbers[6];
  for (const RigAtImage& image : camera.images) {
    const auto rig = poseAt(reference.images, image.time - offset);
    if (!rig) continue;
    const SE3 left2camera = image.left2world.inverse() * *rig;
    const vec3 turn = SO3::log(near.inverse() * left2camera.orient);
    for (int i = 0; i < 3; ++i) {
      numbers[i].push_back(left2camera.pos[i]);
      numbers[3 + i].push_back(turn[i]);
    }
  }
  if (numbers[0].empty())
    throw DataError("slom.calibration.no-motion",
                    {.place = nameOf(camera.data.cameras.front()),
                     .fault = fmt::format("the camera never sees the board while {} does",
                                          reference.data.cameras.front().name),
                     .remedy = "let both see it at the same time"});
  const auto median = [&](int i) { return medianOf(numbers[i]); };
  return SE3(near * SO3::exp(vec3(median(3), median(4), median(5))), vec3(median(0), median(1), median(2)));
}

/// Returns the cameras' results as one, with start values of the poses on the rig.
Result joined(const std::vector<Alone>& all) {
  Result result = all.front().result;
  for (std::size_t c = 1; c < all.size(); ++c) {
    result.cameras.push_back(all[c].result.cameras.front());
    result.rss += all[c].result.rss;
    result.redundancy += all[c].result.redundancy;
  }
  return result;
}

/// Finds the clock and the rotation of a camera by the readings that fit the reference camera.
RatesStart startOf(const Alone& camera, const Alone& reference, const ImuStream& imu) {
  try {
    return startByRates(imu, camera.images, {});
  } catch (const DataError& error) {  // not the fault of the IMU
    throw DataError(error.id(),
                    {.place = nameOf(camera.data.cameras.front()),
                     .fault = fmt::format(
                         "the turns of {} follow the readings of {}, and those of this camera do not: {}",
                         reference.data.cameras.front().name, imu.name, error.parts().fault),
                     .remedy = error.parts().remedy});
  }
}

/// Clocks and shutters with which the fit begins.
struct TimingStart {
  std::vector<CameraClock> clocks;
  std::vector<CameraTiming> timings;
};

/// Returns them, and the poses on the rig. `reference`: of the IMU, by the first camera.
TimingStart startTiming(const std::vector<Alone>& all, const Apart& apart, const ImuStream& imu,
                        const RatesStart& reference, const Settings& settings, const StreamSettings& stream,
                        std::vector<SE3>& left2camera) {
  TimingStart start;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const bool is_late = c > 0 && stream.camera_offsets;
    CameraTiming timing;
    SE3 pose;
    if (c > 0) {
      const double apart_s = double(all.front().epoch_ns - all[c].epoch_ns) * seconds;
      const RatesStart rates = startOf(all[c], all.front(), imu);
      timing.offset = is_late ? reference.offset - rates.offset : apart_s;
      pose = poseOnRig(all.front(), all[c], rates.left2imu.inverse() * reference.left2imu, timing.offset);
    }
    const CameraResult& camera = all[c].result.cameras.front();
    if (camera.readout)
      timing.line_delay =
          camera.readout->value * apart.interval[c] / imageBoxOf(apart.data.cameras[c], camera).height;
    start.clocks.push_back({all[c].epoch_ns, is_late, settings.rolling_shutter});
    start.timings.push_back(timing);
    left2camera.push_back(pose);
  }
  return start;
}

void requireGoodSettings(const Dataset& data, const std::vector<ImuStream>& imus,
                         const StreamSettings& stream) {
  if (imus.empty())
    throw DataError("slom.calibration.bad-stream", "there are no readings; give at least one IMU", "imus");
  if (stream.camera_offsets && data.cameras.size() < 2)
    throw DataError("slom.calibration.bad-settings",
                    "StreamSettings::camera_offsets: there is one camera only; give a second one",
                    "camera_offsets");
}

/// Gives the images of the first camera their numbers back, and all others new ones.
Dataset withGivenNumbers(Dataset data, const Apart& apart) {
  std::map<int, int> others;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      if (apart.given_number.count(view.image) == 0) others.emplace(view.image, 0);
    }
  }
  int next = apart.largest_given;
  for (auto& [image, number] : others) number = ++next;
  for (CameraData& camera : data.cameras) {
    for (View& view : camera.views) {
      const auto given = apart.given_number.find(view.image);
      view.image = given == apart.given_number.end() ? others.at(view.image) : given->second;
    }
  }
  return data;
}

/// What the axes are checked by: the first camera, as if it read all rows at once.
struct Checks {
  Dataset data;
  CamerasAt camera;
  std::vector<RigAtImage> images;
};

/// Returns them after a fit. `simultaneous`: the data at the times of the images. `fitted`: values of the fit.
Checks checksOf(Dataset simultaneous, const CamerasAt& fitted, const std::vector<RigAtImage>& images) {
  Checks checks{std::move(simultaneous), {}, {}};
  checks.data.cameras.resize(1);
  checks.camera.lenses = {fitted.lenses.front()};
  checks.camera.rig.left2camera = {SE3()};
  std::map<int, double> times;
  for (const RigAtImage& image : images) times.emplace(image.image, image.time);
  std::vector<View>& views = checks.data.cameras.front().views;
  std::erase_if(views, [&](const View& view) { return !times.contains(view.image); });
  for (const View& view : views) {
    const SE3& pose = fitted.rig.left2world.at(view.image);
    checks.images.push_back({view.image, times.at(view.image), pose});
    checks.camera.rig.left2world[view.image] = pose;
  }
  return checks;
}

}  // namespace

MovingCameras calibrateMovingCameras(const Dataset& data, const Settings& given,
                                     const std::vector<ImuStream>& imus, const StreamSettings& stream) {
  requireGoodSettings(data, imus, stream);
  const Apart apart = apartOf(data);
  const std::pair<std::vector<Alone>, Dataset> each = calibrateEach(apart, given);
  const std::vector<Alone>& all = each.first;
  const Result cameras = joined(all);
  const DataOnBoard on_board(each.second, cameras.board);
  const std::vector<RigAtImage>& images = all.front().images;
  const std::int64_t epoch_ns = all.front().epoch_ns;
  const Settings settings = settingsOfStreams(given, cameras);
  const Options options = optionsOfStreams(settings);
  UsableStreams usable(imus, given.robust);
  const PreparedStreams prepared = prepare(withoutReadout(all.front().data, all.front().result), images,
                                           epoch_ns, settings, valuesOf(all.front().result), stream, usable);
  SplineValues values = valuesOf(prepared.start);
  values.cameras = valuesOf(cameras);
  values.cameras.rig.left2camera.clear();
  const TimingStart timing = startTiming(all, apart, usable.streams().front(), values.imus.front().start,
                                         given, stream, values.cameras.rig.left2camera);
  values.timings = timing.timings;
  SplineRecording recording{*on_board, settings, images, stream.gravity, stream.knot_spacing, {}};
  recording.clocks = timing.clocks;
  MovingCameras moving;
  CamerasAt fitted;
  Checks checks;
  moving.result = fitBySplines(recording, values, stream, options, [&](const SplineProblem& problem) {
    fitted = problem.values().cameras;
    moving.simultaneous = withGivenNumbers(problem.simultaneous(apart.data), apart);
    checks = checksOf(problem.simultaneous(*on_board), fitted, images);
  });
  reportLags(prepared.lags, moving.result);
  if (stream.axes == ImuAxes::calibrated)
    doubtHeldAxes(checks.data, settings, checks.camera, checks.images, prepared.start.imus, stream.gravity,
                  options, moving.result);
  completeResult(cameras, fitted, imus, epoch_ns, !given.rolling_shutter, moving.result);
  usable.report(moving.result);
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (auto& offset = moving.result.cameras[c].time_offset)
      offset->value += double(all[c].epoch_ns - epoch_ns) * seconds;
  }
  return moving;
}

}  // namespace slom::calibration
