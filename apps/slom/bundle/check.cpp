#include "bundle/check.hpp"

#include <cmath>

#include <fmt/format.h>

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

}  // namespace

std::vector<std::string> checkScene(const Scene& scene) {
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
  if (seen_once.isEmpty()) return {};
  return {fmt::format("{} {} seen by one camera alone: damping alone holds {} along the ray",
                      seen_once.text(), seen_once.choose("is", "are"), seen_once.choose("it", "them"))};
}

}  // namespace slom::app::bundle
