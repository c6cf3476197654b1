#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/fit/rig.hpp"
#include "calibration/median.hpp"
#include "calibration/streams/board_scale.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/doubt.hpp"
#include "calibration/streams/forces.hpp"
#include "calibration/streams/halves.hpp"
#include "calibration/streams/held_axes.hpp"
#include "calibration/streams/joint_fit.hpp"
#include "calibration/streams/preparation.hpp"
#include "calibration/streams/problem.hpp"
#include "calibration/streams/splines/fit.hpp"
#include "calibration/streams/usable_streams.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {
namespace {

/// Returns the rig at all images, in the order of time, and the time of zero in the clock of the cameras.
std::vector<RigAtImage> rigAtImages(const Dataset& data, const Result& cameras, std::int64_t& epoch_ns) {
  std::map<int, std::int64_t> times;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      requireTime(camera, view);
      times.emplace(view.image, *view.time_ns);
    }
  }
  epoch_ns = times.begin()->second;
  for (const auto& [image, time] : times) epoch_ns = std::min(epoch_ns, time);
  std::vector<RigAtImage> images;
  for (const ImageResult& image : cameras.images) {
    const auto time = times.find(image.image);
    if (time != times.end())
      images.push_back({image.image, double(time->second - epoch_ns) * 1e-9, image.left2world});
  }
  std::sort(images.begin(), images.end(),
            [](const RigAtImage& a, const RigAtImage& b) { return a.time < b.time; });
  return images;
}

/// Notes images that count as simultaneous and are not.
void noteOtherTimes(const Dataset& data, StreamResult& result) {
  constexpr double most = 1e-4;  // s: less than corners show
  std::map<int, std::int64_t> first;
  for (const CameraData& camera : data.cameras) {
    std::vector<double> differences;
    for (const View& view : camera.views) {
      const auto [one, is_new] = first.emplace(view.image, *view.time_ns);
      if (!is_new) differences.push_back(std::abs(double(*view.time_ns - one->second)) * 1e-9);
    }
    if (const double median = medianOf(std::move(differences)); median > most)
      addDoubt(
          fmt::format(
              "images of {} count as simultaneous with those of other cameras, and their times differ by "
              "{:.2g} ms in the median",
              camera.name, 1000 * median),
          "if the cameras are not synchronised, add --camera-offsets.", result);
  }
}

/// Rounds in which corners are linearised again at the values of the fit before, and the decrease of the RSS by a fit at
/// which they end: values are then within 0.001 standard deviations of those of the corners themselves.
constexpr int most_linearizations = 10;
constexpr double least_decrease = 1e-6;

/// Fits in rounds. After each, the corners are linearised again at the values of the fit.
Summary optimizeOnCorners(StreamProblem& problem, const Dataset& data, const Options& options) {
  Summary summary = problem.optimize(options);
  for (int round = 1; round < most_linearizations && summary.converged; ++round) {
    const CondensedCorners corners = condensed(data, problem.cameras());
    if (!corners.isFinite()) {
      summary.converged = false;
      summary.message = "the readings pull the cameras to where they do not see the board";
      break;
    }
    problem.setCorners(corners);
    const Summary next = problem.optimize(options);
    const bool is_last = next.initial_rss - next.final_rss < least_decrease;
    const int iterations = summary.iterations + next.iterations;
    summary = next;
    summary.iterations = iterations;
    if (is_last) break;
  }
  return summary;
}

/// Fits by preintegration. `fitted` receives the cameras.
StreamResult fitByPreintegration(const Dataset& data, const std::vector<RigAtImage>& images,
                                 const Options& options, double gravity, const StreamStart& start,
                                 CamerasAt& fitted) {
  StreamProblem problem(data, condensed(data, start.cameras), start.settings, start.cameras, images, start.up,
                        start.imus, gravity);
  StreamResult result = problem.result(optimizeOnCorners(problem, data, options));
  result.sigma_px = start.settings.sigma_px;
  fitted = problem.cameras();
  if (result.success()) {
    const CondensedCorners corners = condensed(data, fitted);
    addHalves(
        problem.started(), images,
        [&](const std::vector<StartedImu>& imus) {
          StreamProblem half(data, corners, start.settings, fitted, images, problem.up(), imus, gravity);
          return half.optimize(options).converged ? half.posesOfImus() : PosesOfImus();
        },
        result);
  }
  noteBoardScale([&] { return problem.boardScale(options); }, start.imus.front().axes, result);
  return result;
}

void requireGoodSettings(const StreamSettings& stream) {
  if (stream.camera_offsets)
    throw DataError(
        "slom.calibration.bad-settings",
        "StreamSettings::camera_offsets are estimated by calibrateMovingCameras(); call it instead",
        "camera_offsets");
}

}  // namespace

std::string toString(ImuAxes axes) {
  if (axes == ImuAxes::calibrated) return "calibrated";
  return axes == ImuAxes::scale_misalignment ? "scale-misalignment" : "scale-misalignment-size-effect";
}

const char* toString(StreamPath path) { return path == StreamPath::splines ? "splines" : "preintegration"; }

StreamResult calibrateStreams(const Dataset& data, const Settings& given, const Result& cameras,
                              const std::vector<ImuStream>& imus, const StreamSettings& stream) {
  if (!cameras.success())
    throw DataError("slom.calibration.no-result", "the cameras' own calibration did not succeed", "cameras");
  if (imus.empty())
    throw DataError("slom.calibration.bad-stream", "there are no readings; give at least one IMU", "imus");
  requireGoodSettings(stream);
  const SortedDataset sorted(data);
  const Dataset accepted = asFitted(cameras, withoutRejected(*sorted, cameras));
  const DataOnBoard on_board(accepted, cameras.board);
  std::int64_t epoch_ns = 0;
  const std::vector<RigAtImage> images = rigAtImages(*on_board, cameras, epoch_ns);
  UsableStreams usable(imus, given.robust);
  const Settings settings = settingsOfStreams(given, cameras);
  const Options options = optionsOfStreams(settings);
  const PreparedStreams prepared =
      prepare(*on_board, images, epoch_ns, settings, valuesOf(cameras), stream, usable);
  CamerasAt fitted;
  StreamResult result =
      stream.path == StreamPath::preintegration
          ? fitByPreintegration(*on_board, images, options, stream.gravity, prepared.start, fitted)
          : fitBySplines({*on_board, settings, images, stream.gravity, stream.knot_spacing, {}},
                         valuesOf(prepared.start), stream, options,
                         [&](const SplineProblem& problem) { fitted = problem.values().cameras; });
  reportLags(prepared.lags, result);
  if (stream.axes == ImuAxes::calibrated)
    doubtHeldAxes(*on_board, settings, fitted, images, prepared.start.imus, stream.gravity, options, result);
  completeResult(cameras, fitted, imus, epoch_ns, true, result);
  noteOtherTimes(*on_board, result);
  usable.report(result);
  return result;
}

}  // namespace slom::calibration
