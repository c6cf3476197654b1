#include "bundle/check.hpp"

#include <cmath>

#include <fmt/format.h>

#include "bundle/fit/free_directions.hpp"
#include "bundle/fit/parts.hpp"
#include "error.hpp"
#include "text.hpp"

namespace slom::app::bundle {

namespace {

/// Items of one kind that have a fault: their number, and the indices of the first ones.
class Faulty {
 public:
  explicit Faulty(const char* kind) : kind_(kind) {}

  void add(std::size_t number) {
    constexpr std::size_t most_named = 5;
    if (++count_ <= most_named) {
      names_ += fmt::format("{}{}", count_ == 1 ? "" : ", ", number);
    } else if (count_ == most_named + 1) {
      names_ += ", ...";
    }
  }
  bool isEmpty() const { return count_ == 0; }
  std::size_t count() const { return count_; }
  /// Returns `2 points (numbers 3, 7)`.
  std::string text() const {
    return fmt::format("{} (number{} {})", plural(count_, kind_), count_ == 1 ? "" : "s", names_);
  }
  /// Returns `3, 7`.
  const std::string& names() const { return names_; }
  const char* choose(const char* for_one, const char* for_many) const {
    return count_ == 1 ? for_one : for_many;
  }

 private:
  const char* kind_;
  std::size_t count_ = 0;
  std::string names_;
};

/// Number of cameras that see a point.
enum class Seen : unsigned char { by_none, by_one, by_several };

struct Views {
  explicit Views(const Scene& scene)
      : has_camera(scene.cameras.size()), points(scene.points.size()), first_camera(scene.points.size()) {
    for (const Observation& observation : scene.observations) {
      const auto p = std::size_t(observation.point);
      has_camera[std::size_t(observation.camera)] = true;
      if (points[p] == Seen::by_none) {
        points[p] = Seen::by_one;
        first_camera[p] = observation.camera;
      } else if (first_camera[p] != observation.camera) {
        points[p] = Seen::by_several;
      }
    }
  }
  std::vector<bool> has_camera;  ///< by camera: whether it sees anything
  std::vector<Seen> points;
  std::vector<int> first_camera;  ///< by point: first camera that sees it
};

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

void refusePointsWithoutImage(const Scene& scene) {
  constexpr double no_depth = 1e-9;  // relative to the distance: no lens has so wide an image
  for (const Observation& observation : scene.observations) {
    const mtk::vect<3> p = inCamera(scene, observation);
    if (std::isfinite(scene.residual(observation).squaredNorm())) {
      if (std::abs(p[2]) > no_depth * p.norm()) continue;
      throw UserError(fmt::format(
          "{}:{}: point {} lies in the plane of camera {} (depth {:.3g} at a distance of {:.3g}), where a "
          "point has no image; correct the point or the camera, or remove the observation",
          scene.file, observation.line, observation.point, observation.camera, std::abs(p[2]), p.norm()));
    }
    throw UserError(
        fmt::format("{}:{}: point {} has no image in camera {}: the prediction is not a finite number; "
                    "correct the point or the camera, or remove the observation",
                    scene.file, observation.line, observation.point, observation.camera));
  }
}

SceneCheck examine(const Scene& scene, const Faulty& seen_once) {
  SceneCheck check;
  auto& warnings = check.warnings;
  const Sightings sightings(scene);
  const std::vector<Part> parts = sightings.parts();
  if (parts.size() > 1) {
    Faulty first("part");
    for (const Part& part : parts) first.add(std::size_t(part.cameras.front()));
    warnings.push_back(fmt::format(
        "the scene has {} parts that share no point, with the cameras {}: their relative place, rotation and "
        "scale are unknown, so {} more directions are free; add observations of common points, or fit each "
        "part alone",
        parts.size(), first.names(), similarity * (int(parts.size()) - 1)));
  }
  Faulty few("camera");
  int most_free = 0;  // largest number of free unknowns, of 9, of such a camera
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const std::size_t points = sightings.pointsOf(int(c)).size();
    if (points > few_points) continue;
    few.add(c);
    most_free += 9 - 2 * int(points);
  }
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
  check.parts = int(parts.size());
  return check;
}

}  // namespace

std::string behindText(const Scene& scene) {
  std::vector<char> is_behind(scene.points.size());
  std::size_t observations = 0;
  for (const Observation& observation : scene.observations) {
    if (inCamera(scene, observation)[2] < 0) continue;
    ++observations;
    is_behind[std::size_t(observation.point)] = 1;
  }
  if (observations == 0) return "";
  Faulty behind("point");
  for (std::size_t p = 0; p < is_behind.size(); ++p) {
    if (is_behind[p] != 0) behind.add(p);
  }
  return fmt::format(
      "{} {} behind cameras that see {} ({}), which is impossible: start {} in front of the "
      "cameras, or remove {}",
      behind.text(), behind.choose("ends", "end"), behind.choose("it", "them"),
      plural(observations, "observation"), behind.choose("it", "them"), behind.choose("it", "them"));
}

std::string dominantText(const Scene& scene) {
  constexpr double nearly_all = 0.9;
  constexpr std::size_t least_observations = 10;  // among fewer, one may well have most of the RSS
  double sum = 0, most = 0;
  const Observation* worst = nullptr;
  for (const Observation& observation : scene.observations) {
    const double square = scene.residual(observation).squaredNorm();
    sum += square;
    if (square <= most) continue;
    most = square;
    worst = &observation;
  }
  if (worst == nullptr || scene.observations.size() < least_observations || !(most > nearly_all * sum))
    return "";
  return fmt::format(
      "; the observation on line {}, of point {} by camera {}, has {:.3g} % of the sum of squares: correct "
      "or remove it",
      worst->line, worst->point, worst->camera, 100 * most / sum);
}

SceneCheck checkScene(const Scene& scene) {
  const Views views(scene);
  Faulty cameras("camera"), unseen("point"), seen_once("point");
  for (std::size_t c = 0; c < views.has_camera.size(); ++c) {
    if (!views.has_camera[c]) cameras.add(c);
  }
  for (std::size_t p = 0; p < views.points.size(); ++p) {
    if (views.points[p] == Seen::by_none) unseen.add(p);
    if (views.points[p] == Seen::by_one) seen_once.add(p);
  }
  refuseUnseen(scene, cameras);
  refuseUnseen(scene, unseen);
  refusePointsWithoutImage(scene);
  return examine(scene, seen_once);
}

}  // namespace slom::app::bundle
