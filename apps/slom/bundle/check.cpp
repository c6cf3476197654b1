#include "bundle/check.hpp"

#include <cmath>

#include <fmt/format.h>

#include "bundle/fit/free_directions.hpp"
#include "bundle/fit/parts.hpp"
#include "error.hpp"
#include "text.hpp"

namespace slom::app::bundle {

namespace {

/// Which things of one kind have a fault: how many, and the numbers of the first ones.
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
  /// `2 points (numbers 3, 7)`
  std::string text() const {
    return fmt::format("{} (number{} {})", plural(count_, kind_), count_ == 1 ? "" : "s", names_);
  }
  /// `3, 7`
  const std::string& names() const { return names_; }
  const char* choose(const char* for_one, const char* for_many) const {
    return count_ == 1 ? for_one : for_many;
  }

 private:
  const char* kind_;
  std::size_t count_ = 0;
  std::string names_;
};

/// Who sees a point.
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
  std::vector<bool> has_camera;  ///< whether the camera sees anything
  std::vector<Seen> points;
  std::vector<int> first_camera;  ///< that sees the point
};

void refuseUnseen(const Scene& scene, const Faulty& unseen) {
  if (unseen.isEmpty()) return;
  throw UserError(fmt::format(
      "{}: {} {} no observation, so that nothing determines {}; add observations, or remove {}", scene.file,
      unseen.text(), unseen.choose("has", "have"), unseen.choose("it", "them"), unseen.choose("it", "them")));
}

void refusePointsWithoutImage(const Scene& scene) {
  for (const Observation& observation : scene.observations) {
    if (std::isfinite(scene.residual(observation).squaredNorm())) continue;
    throw UserError(
        fmt::format("{}:{}: point {} has no image in camera {}, as the prediction is not a finite number; "
                    "correct the two, or remove this observation",
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
        "the scene falls into {} parts that share no point, with the cameras {}: nothing says how they lie to "
        "each other; add observations of common points, or fit each part by itself",
        parts.size(), first.names()));
  }
  Faulty few("camera");
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    if (sightings.pointsOf(int(c)).size() <= few_points) few.add(c);
  }
  if (!few.isEmpty()) {
    warnings.push_back(fmt::format(
        "{} {} fewer than {} points, too few for the 9 unknowns of a camera: damping alone holds the rest; add "
        "observations, or remove {}",
        few.text(), few.choose("sees", "see"), few_points + 1, few.choose("it", "them")));
  }
  if (!seen_once.isEmpty()) {
    warnings.push_back(fmt::format("{} {} seen by one camera alone: damping alone holds {} along the ray",
                                   seen_once.text(), seen_once.choose("is", "are"),
                                   seen_once.choose("it", "them")));
  }
  check.parts = int(parts.size());
  return check;
}

}  // namespace

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
