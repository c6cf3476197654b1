// Start values of the rig: the poses of the cameras on it, and its pose in each image.
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

/// Computes camera to camera from common images, along the tree with the most common images. Takes the board pose of
/// an image from the reference camera if it saw the board, otherwise from the camera with the most corners.
/// `world2camera[c]` belongs to `data.cameras[c]`; checkConnected(data) must hold.
RigStart startRig(const Dataset& data, const std::vector<ViewPoses>& world2camera);

}  // namespace slom::calibration
