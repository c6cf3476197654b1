#include "calibrate/quality/board.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "calibrate/input/board_plane.hpp"

namespace slom::app::calib {

BoardOutline outlineOf(const View& view) {
  constexpr int angles = 180;  // over a quarter of a turn
  const BoardPlane plane = fitPlane(view.corners);
  BoardOutline best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2 * angles; ++i) {
    const SO3 turn = SO3::exp(vec3(0., 0., std::numbers::pi * i / (2 * angles)));
    vec3 low(1e300, 1e300, 0.), high(-1e300, -1e300, 0.);
    for (const Corner& corner : view.corners) {
      const vec3 p = turn.inverse() * (plane.plane2world.inverse() * corner.world);
      low = vec3(low.cwiseMin(p)), high = vec3(high.cwiseMax(p));
    }
    const vec3 size(high - low);
    const double area = size.x() * size.y();
    if (!(area < least * (1 - 1e-9)) || size.x() < size.y()) continue;
    least = area;
    const vec3 centre((low.x() + high.x()) / 2, (low.y() + high.y()) / 2, 0.);
    best = {plane.plane2world * SE3(turn) * SE3(centre), size.x(), size.y()};
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
  return *most;
}

}  // namespace slom::app::calib
