// Start values of the intrinsics, from the homographies of a camera's views.
#pragma once

#include <optional>
#include <vector>

#include "calibration/initialization/plane_view.hpp"
#include "calibration/models/camera.hpp"

namespace slom::calibration {

/// fx, fy, cx, cy in closed form, without skew, from at least two homographies. Nothing when the views leave
/// them open (boards parallel to each other or to the image) or noise makes the conic no camera's. Source:
/// Zhang, A flexible new technique for camera calibration, PAMI 2000, section 3.1.
std::optional<Pinhole> zhang(const std::vector<Eigen::Matrix3d>& homographies);

/// The focal length alone (fx = fy), for a known principal point. Nothing when all boards are parallel to the
/// image.
std::optional<Pinhole> zhangFocalLength(const std::vector<Eigen::Matrix3d>& homographies, const vec2& centre);

/// How a start value of the intrinsics was found.
struct IntrinsicsStart {
  Pinhole pinhole;
  const char* source = "";  ///< a few words for the report
};

/// The best of Zhang's closed form, the focal length for a principal point amid the corners, and guessed
/// focal lengths: whichever puts the corners nearest to their pixels.
IntrinsicsStart startIntrinsics(const std::vector<PlaneView>& views);

}  // namespace slom::calibration
