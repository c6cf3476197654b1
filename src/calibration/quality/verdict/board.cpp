#include "slom/calibration/board.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "slom/calibration/error.hpp"

namespace slom::calibration {

BoardOutline outlineOf(const View& view) {
  constexpr int angles = 180;  // over a quarter of a turn
  const BoardPlane plane = fitPlane(view.corners);
  std::vector<vec2> points;
  for (const Corner& corner : view.corners) points.push_back(plane.coordinates(corner.world));
  BoardOutline best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2 * angles; ++i) {
    const double angle = std::numbers::pi * i / (2 * angles), cosine = std::cos(angle),
                 sine = std::sin(angle);
    vec2 low(1e300, 1e300), high(-1e300, -1e300);
    for (const vec2& p : points) {
      const vec2 turned(cosine * p.x() + sine * p.y(), cosine * p.y() - sine * p.x());
      low = vec2(low.cwiseMin(turned)), high = vec2(high.cwiseMax(turned));
    }
    const vec2 size(high - low);
    const double area = size.x() * size.y();
    if (!(area < least * (1 - 1e-9)) || size.x() < size.y()) continue;
    least = area;
    const vec3 centre((low.x() + high.x()) / 2, (low.y() + high.y()) / 2, 0.);
    best = {plane.plane2world * SE3(SO3::exp(vec3(0., 0., angle))) * SE3(centre), size.x(), size.y()};
  }
  return best;
}

const View& fullestView(const Dataset& data) {
  const View* most = nullptr;
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      if (!most || view.corners.size() > most->corners.size()) most = &view;
    }
  }
  if (most) return *most;
  throw DataError("slom.calibration.too-few-views", "there is no view in the data set; add some", "data");
}

}  // namespace slom::calibration
