// Views that are seen at times of their own, row by row, as measurements; and the data that a rig at rest would have seen.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "calibration/median.hpp"
#include "calibration/streams/splines/place_view.hpp"
#include "calibration/streams/splines/problem.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t most_bands = 8, fewest_of_band = 4;  ///< corners

/// Returns the corners in bands of rows: so many of each that a pose and a lens follow from them.
std::vector<std::vector<Corner>> bandsOf(const View& view) {
  std::vector<Corner> corners = view.corners;
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.pixel.y() < b.pixel.y(); });
  const std::size_t bands = std::clamp<std::size_t>(corners.size() / fewest_of_band, 1, most_bands);
  std::vector<std::vector<Corner>> all;
  for (std::size_t b = 0; b < bands; ++b)
    all.emplace_back(corners.begin() + std::ptrdiff_t(corners.size() * b / bands),
                     corners.begin() + std::ptrdiff_t(corners.size() * (b + 1) / bands));
  return all;
}

double meanRow(const std::vector<Corner>& corners) {
  double sum = 0;
  for (const Corner& corner : corners) sum += corner.pixel.y() / double(corners.size());
  return sum;
}

}  // namespace

double SplineProblem::timeOf(std::size_t camera, const RowTime& time) const {
  return time.at(double(*timings_[camera].offset), double(*timings_[camera].line_delay));
}

RowTime SplineProblem::rowTimeOf(std::size_t camera, const View& view, double row) const {
  return {double(*view.time_ns - recording_.clocks[camera].epoch_ns) * 1e-9, row};
}

std::optional<std::size_t> SplineProblem::stretchAt(double time) const {
  const double margin = recording_.knot_spacing / 2;  // the last segment continues
  for (std::size_t s = 0; s < recording_.stretches.size(); ++s) {
    const Stretch& stretch = recording_.stretches[s];
    if (time >= stretch.from - margin && time <= stretch.to + margin) return s;
  }
  return {};
}

SE3 SplineProblem::poseAt(std::size_t stretch, double time) const {
  const RigSpline& spline = splines_[stretch];
  return spline
      .segmentAt(std::clamp(time, recording_.stretches[stretch].from, recording_.stretches[stretch].to))
      .poseAt(time);
}

void SplineProblem::insertMovingView(std::size_t camera, const View& view, LensRows& rows) {
  const bool is_rolling =
      recording_.clocks[camera].is_line_delay_estimated || start_.timings[camera].line_delay != 0;
  const auto bands = is_rolling ? bandsOf(view) : std::vector<std::vector<Corner>>{view.corners};
  for (const std::vector<Corner>& band : bands)
    insertBand(camera, rowTimeOf(camera, view, is_rolling ? meanRow(band) : 0), band, rows);
}

void SplineProblem::insertBand(std::size_t camera, const RowTime& time, const std::vector<Corner>& corners,
                               LensRows& rows) {
  const double at = timeOf(camera, time);
  const auto stretch = stretchAt(at);
  if (!stretch) return;
  std::vector<SE3> poses;
  for (const Corner& corner : corners)
    poses.push_back(poseAt(*stretch, timeOf(camera, {time.stamp, time.row == 0 ? 0 : corner.pixel.y()})));
  const auto view = std::make_shared<CondensedView>(condensed(corners, *lenses_[camera],
                                                              camera == 0 ? SE3() : *left2camera_[camera],
                                                              poseAt(*stretch, at), poses, rows));
  const RigSpline& spline = splines_[*stretch];
  const auto [segment, first] = controlsAt(spline, at);
  const ViewInTime in_time(view, trajectory::Blending<pose_order>(spline.knots(), segment), time);
  const CameraClock& clock = recording_.clocks[camera];
  const std::pair lens(lenses_[camera], true);
  const std::pair offset(timings_[camera].offset, clock.is_offset_estimated),
      line_delay(timings_[camera].line_delay, clock.is_line_delay_estimated);
  camera == 0 ? place(in_time, *stretch, first, timeGroup(at), lens, offset, line_delay)
              : place(in_time, *stretch, first, timeGroup(at), lens, std::pair(left2camera_[camera], true),
                      offset, line_delay);
}

namespace {

/// A view and the time to which its corners are moved.
struct MovedView {
  std::size_t camera = 0, view = 0;
  double time = 0;  ///< of the image of the first camera, of the middle of the corners of others
  std::optional<std::size_t> image{};  ///< index of the reference camera's image that is nearest
};

/// Returns the images of the reference camera, each with the nearest view of a camera, if both are the nearest to each
/// other and not farther away than half of the usual time between images.
void pairWithImages(const std::vector<RigAtImage>& images, std::vector<MovedView>& views) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < images.size(); ++i) gaps.push_back(images[i].time - images[i - 1].time);
  const double most = medianOf(gaps) / 2;
  std::map<std::pair<std::size_t, std::size_t>, MovedView*> nearest;  // by camera and image
  for (MovedView& view : views) {
    const auto next = std::lower_bound(images.begin(), images.end(), view.time,
                                       [](const RigAtImage& image, double t) { return image.time < t; });
    std::size_t i = std::min<std::size_t>(std::size_t(next - images.begin()), images.size() - 1);
    if (i > 0 && view.time - images[i - 1].time < images[i].time - view.time) --i;
    const double distance = std::abs(images[i].time - view.time);
    if (distance > most) continue;
    MovedView*& before = nearest[{view.camera, i}];
    if (before && std::abs(images[i].time - before->time) <= distance) continue;
    if (before) before->image.reset();
    before = &view;
    view.image = i;
  }
}

}  // namespace

View SplineProblem::movedTo(double to, std::size_t camera, View view) const {
  const std::size_t stretch = *stretchAt(timeOf(camera, rowTimeOf(camera, view, meanRow(view.corners))));
  const SE3 left2camera = camera == 0 ? SE3() : *left2camera_[camera];
  const auto pixelAt = [&](const Corner& corner, double time) {
    return lenses_[camera]->project(vec3(left2camera * poseAt(stretch, time).inverse() * corner.world));
  };
  for (Corner& corner : view.corners) {
    const double time = timeOf(camera, rowTimeOf(camera, view, corner.pixel.y()));
    const vec2 change = vec2(pixelAt(corner, to) - pixelAt(corner, time));
    if (change.allFinite()) corner.pixel += change;
  }
  return view;
}

Dataset SplineProblem::simultaneous(const Dataset& data) const {
  std::vector<MovedView> views;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (std::size_t v = 0; v < data.cameras[c].views.size(); ++v) {
      const View& view = data.cameras[c].views[v];
      const double middle = timeOf(c, rowTimeOf(c, view, meanRow(view.corners)));
      const double time = c == 0 ? timeOf(c, rowTimeOf(c, view, 0)) : middle;
      if (stretchAt(middle)) views.push_back({c, v, time});
    }
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const MovedView& a, const MovedView& b) { return a.time < b.time; });
  pairWithImages(recording_.images, views);
  int last = 0;
  for (const RigAtImage& image : recording_.images) last = std::max(last, image.image);
  Dataset moved = data;
  for (CameraData& camera : moved.cameras) camera.views.clear();
  for (const MovedView& one : views) {
    const View& view = data.cameras[one.camera].views[one.view];
    const double to = one.image ? recording_.images[*one.image].time : one.time;
    View& next = moved.cameras[one.camera].views.emplace_back(movedTo(to, one.camera, view));
    next.image = one.image ? recording_.images[*one.image].image : ++last;
    next.time_ns = recording_.clocks[0].epoch_ns + std::llround(1e9 * to);
  }
  return moved;
}

}  // namespace slom::calibration
