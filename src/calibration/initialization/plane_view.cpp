#include "calibration/initialization/plane_view.hpp"

#include "slom/calibration/board.hpp"

namespace slom::calibration {

PlaneView::PlaneView(const View& view) : plane(fitPlane(view.corners)) {
  for (const Corner& corner : view.corners) {
    board.push_back(plane.coordinates(corner.world));
    pixels.push_back(corner.pixel);
  }
  homography = findHomography(board, pixels);
}

std::vector<PlaneView> planeViews(const CameraData& camera) {
  return {camera.views.begin(), camera.views.end()};
}

}  // namespace slom::calibration
