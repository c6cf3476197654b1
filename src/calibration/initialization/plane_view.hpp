// A view as a map from plane to image: board plane, homography, and the corners in both.
#pragma once

#include <vector>

#include "slom/calibration/board.hpp"

namespace slom::calibration {

struct PlaneView {
  BoardPlane plane;
  std::vector<vec2> board;   ///< corners in the plane [m]
  std::vector<vec2> pixels;  ///< the same corners in the image [px]
  Eigen::Matrix3d homography;

  explicit PlaneView(const View& view);
};

std::vector<PlaneView> planeViews(const CameraData& camera);

}  // namespace slom::calibration
