#include "bundle/check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "bundle/faulty.hpp"
#include "bundle/fit/free_directions.hpp"
#include "disjoint_sets.hpp"
#include "error.hpp"
#include "text.hpp"

namespace slom::app::bundle {

namespace {

/// Number of cameras that see a point.
enum class Seen : unsigned char { by_none, by_one, by_several };

/// The first few points that a camera sees, each once: one more than are too few.
class FewPoints {
 public:
  void add(int point) {
    const auto end = points_.begin() + count_;
    if (count_ < int(points_.size()) && std::find(points_.begin(), end, point) == end)
      points_[std::size_t(count_++)] = point;
  }
  int count() const { return count_; }

 private:
  std::array<int, few_points + 1> points_{};
  int count_ = 0;
};

/// What the observations of this process say about cameras and points, by place.
struct Views {
  explicit Views(const Scene& scene)
      : points_of(scene.cameras.size()),
        joined(scene.cameras.size()),
        seen(scene.points.size()),
        first_camera(scene.points.size()) {
    for (const Observation& observation : scene.observations) {
      const auto p = std::size_t(observation.point);
      points_of[std::size_t(observation.camera)].add(observation.point);
      if (seen[p] == Seen::by_none) {
        seen[p] = Seen::by_one;
        first_camera[p] = observation.camera;
      } else if (first_camera[p] != observation.camera) {
        seen[p] = Seen::by_several;
        joined.join(first_camera[p], observation.camera);
      }
    }
  }
  std::vector<FewPoints> points_of;
  DisjointSets joined;  ///< cameras with common points
  std::vector<Seen> seen;
  std::vector<int> first_camera;  ///< by point: first camera that sees it
};

/// What one process has seen of a camera. Cameras are numbered as in the file.
struct SeenCamera {
  int camera, joined_with, points;
};

/// Returns the cameras as each process has seen them.
std::vector<SeenCamera> camerasOfAll(Views& views, const SceneNumbers& numbers, const Collective& processes) {
  std::vector<SeenCamera> all;
  for (std::size_t c = 0; c < views.points_of.size(); ++c)
    all.push_back({numbers.cameras[c], numbers.cameras[std::size_t(views.joined.find(int(c)))],
                   views.points_of[c].count()});
  if (processes.isAlone()) return all;
  const std::string own(reinterpret_cast<const char*>(all.data()), all.size() * sizeof(SeenCamera));
  all.clear();
  for (const std::string& bytes : processes.gather(own)) {
    const std::size_t before = all.size();
    all.resize(before + bytes.size() / sizeof(SeenCamera));
    std::memcpy(all.data() + before, bytes.data(), bytes.size());
  }
  return all;
}

void refuseUnseen(const Scene& scene, const Faulty& unseen) {
  if (unseen.isEmpty()) return;
  throw UserError(fmt::format(
      "{}: {} {} no observation, so nothing determines {}; add observations, or remove {}", scene.file,
      unseen.text(), unseen.choose("has", "have"), unseen.choose("it", "them"), unseen.choose("it", "them")));
}

/// The point in the camera's frame, which looks along -z.
mtk::vect<3> inCamera(const Scene& scene, const Observation& observation) {
  return scene.cameras[std::size_t(observation.camera)].pose * scene.points[std::size_t(observation.point)];
}

void refusePointsWithoutImage(const Scene& scene, const SceneNumbers& numbers) {
  constexpr double no_depth = 1e-9;  // relative to the distance: no lens has so wide an image
  for (const Observation& observation : scene.observations) {
    const mtk::vect<3> p = inCamera(scene, observation);
    const int point = numbers.points[std::size_t(observation.point)],
              camera = numbers.cameras[std::size_t(observation.camera)];
    if (std::isfinite(scene.residual(observation).squaredNorm())) {
      if (std::abs(p[2]) > no_depth * p.norm()) continue;
      throw UserError(fmt::format(
          "{}:{}: point {} lies in the plane of camera {} (depth {:.3g} at a distance of {:.3g}), where a "
          "point has no image; correct the point or the camera, or remove the observation",
          scene.file, observation.line, point, camera, std::abs(p[2]), p.norm()));
    }
    throw UserError(
        fmt::format("{}:{}: point {} has no image in camera {}: the prediction is not a finite number; "
                    "correct the point or the camera, or remove the observation",
                    scene.file, observation.line, point, camera));
  }
}

SceneCheck examine(const std::vector<SeenCamera>& cameras, const Faulty& seen_once, int camera_count) {
  SceneCheck check;
  check.points_seen_once = seen_once.count();
  auto& warnings = check.warnings;
  DisjointSets joined{std::size_t(camera_count)};
  std::vector<int> points(std::size_t(camera_count), 0);  // at least; exact if they are few
  for (const SeenCamera& seen : cameras) {
    joined.join(seen.camera, seen.joined_with);
    points[std::size_t(seen.camera)] += seen.points;
  }
  Faulty first("part"), few("camera");
  int most_free = 0;  // largest number of free unknowns, of 9, of cameras with few points
  for (int c = 0; c < camera_count; ++c) {
    if (joined.find(c) == c) first.add(c);
    const int count = points[std::size_t(c)];
    if (count > int(few_points)) continue;
    few.add(c);
    most_free += 9 - 2 * count;
  }
  check.parts = int(first.count());
  if (check.parts > 1)
    warnings.push_back(fmt::format(
        "the scene has {} parts that share no point, with the cameras {}: their relative place, rotation and "
        "scale are unknown, so {} more directions are free; add observations of common points, or fit each "
        "part alone",
        check.parts, first.names(), similarity * (check.parts - 1)));
  if (!few.isEmpty()) {
    warnings.push_back(fmt::format(
        "{} {} fewer than {} points, too few for the 9 unknowns of a camera: only damping holds the rest, up "
        "to {}; "
        "add observations, or remove {}",
        few.text(), few.choose("sees", "see"), few_points + 1,
        plural(std::size_t(most_free), "free direction"), few.choose("it", "them")));
  }
  if (!seen_once.isEmpty()) {
    warnings.push_back(fmt::format("{} {} seen by only one camera: only damping holds {} along the ray, {}",
                                   seen_once.text(), seen_once.choose("is", "are"),
                                   seen_once.choose("it", "them"),
                                   plural(seen_once.count(), "free direction")));
  }
  return check;
}

}  // namespace

std::string behindText(const Scene& scene, const SceneNumbers& numbers, const Collective& processes) {
  std::vector<char> is_behind(scene.points.size());
  std::size_t own = 0;
  for (const Observation& observation : scene.observations) {
    if (inCamera(scene, observation)[2] < 0) continue;
    ++own;
    is_behind[std::size_t(observation.point)] = 1;
  }
  const auto observations = std::size_t(processes.sum(double(own)));
  if (observations == 0) return "";
  Faulty behind("point");
  for (std::size_t p = 0; p < is_behind.size(); ++p) {
    if (is_behind[p] != 0) behind.add(numbers.points[p]);
  }
  behind.addUp(processes);
  return fmt::format(
      "{} {} behind cameras that see {} ({}), which is impossible: start {} in front of the "
      "cameras, or remove {}",
      behind.text(), behind.choose("ends", "end"), behind.choose("it", "them"),
      plural(observations, "observation"), behind.choose("it", "them"), behind.choose("it", "them"));
}

std::string dominantText(const Scene& scene, const SceneNumbers& numbers, const Collective& processes) {
  constexpr double nearly_all = 0.9;
  constexpr std::int64_t least_observations = 10;  // among fewer, one may well have most of the RSS
  double sum = 0, most = 0;
  const Observation* worst = nullptr;
  for (const Observation& observation : scene.observations) {
    const double square = scene.residual(observation).squaredNorm();
    sum += square;
    if (square <= most) continue;
    most = square;
    worst = &observation;
  }
  sum = processes.sum(sum);
  const double most_of_all = processes.max(most);
  if (numbers.observation_count < least_observations || !(most_of_all > nearly_all * sum)) return "";
  std::string own;
  if (worst != nullptr && most == most_of_all)
    own = fmt::format(
        "; the observation on line {}, of point {} by camera {}, has {:.3g} % of the sum of squares: correct "
        "or remove it",
        worst->line, numbers.points[std::size_t(worst->point)], numbers.cameras[std::size_t(worst->camera)],
        100 * most / sum);
  for (const std::string& text : processes.gather(own)) {
    if (!text.empty()) return text;
  }
  return "";
}

SceneCheck checkScene(const Scene& scene, const SceneNumbers& numbers, const Collective& processes) {
  Views views(scene);
  Faulty cameras("camera"), unseen("point"), seen_once("point");
  for (std::size_t c = 0; c < views.points_of.size(); ++c) {
    if (views.points_of[c].count() == 0) cameras.add(numbers.cameras[c]);
  }
  for (std::size_t p = 0; p < views.seen.size(); ++p) {
    if (views.seen[p] == Seen::by_none) unseen.add(numbers.points[p]);
    if (views.seen[p] == Seen::by_one) seen_once.add(numbers.points[p]);
  }
  processes.agree([&] {
    refuseUnseen(scene, cameras);
    refuseUnseen(scene, unseen);
    refusePointsWithoutImage(scene, numbers);
  });
  seen_once.addUp(processes);
  return examine(camerasOfAll(views, numbers, processes), seen_once, numbers.camera_count);
}

}  // namespace slom::app::bundle
