// Start values of the rig: where the cameras sit on it, and where it was in each image.
#pragma once

#include <map>
#include <vector>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// World to camera by image number, from a single camera.
using ViewPoses = std::map<int, SE3>;

struct RigStart {
  std::vector<SE3> left2camera;   ///< by camera; the identity for the first, the reference ("left")
  std::map<int, SE3> left2world;  ///< by image
};

/// Camera to camera by common images, along the tree that shares the most of them; the board poses from the
/// reference camera where it saw the image, otherwise from the camera that saw the most corners.
/// `world2camera[c]` belongs to `data.cameras[c]`; checkConnected(data) must hold.
RigStart startRig(const Dataset& data, const std::vector<ViewPoses>& world2camera);

}  // namespace slom::calibration
