#include "bundle/fit/parts.hpp"

#include <algorithm>
#include <utility>

namespace slom::app::bundle {

Sightings::Sightings(const Scene& scene)
    : points_of_(scene.cameras.size()), cameras_of_(scene.points.size()) {
  for (const Observation& o : scene.observations) points_of_[std::size_t(o.camera)].push_back(o.point);
  for (std::size_t c = 0; c < points_of_.size(); ++c) {
    auto& points = points_of_[c];
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (const int p : points) cameras_of_[std::size_t(p)].push_back(int(c));
  }
}

void Sightings::remove(int camera, int point) {
  std::erase(points_of_[std::size_t(camera)], point);
  std::erase(cameras_of_[std::size_t(point)], camera);
}

std::vector<Part> Sightings::parts() const {
  std::vector<char> has_camera(points_of_.size()), has_point(cameras_of_.size());
  std::vector<Part> parts;
  for (std::size_t first = 0; first < points_of_.size(); ++first) {
    if (points_of_[first].empty() || std::exchange(has_camera[first], char(1)) != 0) continue;
    Part& part = parts.emplace_back();
    part.cameras.push_back(int(first));
    for (std::size_t i = 0; i < part.cameras.size(); ++i) {
      for (const int p : pointsOf(part.cameras[i])) {
        if (std::exchange(has_point[std::size_t(p)], char(1)) != 0) continue;
        part.points.push_back(p);
        for (const int c : camerasOf(p)) {
          if (std::exchange(has_camera[std::size_t(c)], char(1)) == 0) part.cameras.push_back(c);
        }
      }
    }
  }
  return parts;
}

}  // namespace slom::app::bundle
