// Start values of the intrinsics, from the homographies of a camera's views.
#pragma once

#include <optional>
#include <vector>

#include "calibration/initialization/plane_view.hpp"
#include "calibration/models/camera.hpp"

namespace slom::calibration {

/// Computes fx, fy, cx, cy in closed form, without skew, from at least two homographies. Returns nothing if the views
/// leave them open (boards parallel to each other or to the image), or if noise makes the conic impossible for a
/// camera. Source: Zhang, A flexible new technique for camera calibration, PAMI 2000, section 3.1.
std::optional<Pinhole> zhang(const std::vector<Eigen::Matrix3d>& homographies);

/// Computes only the focal length (fx = fy), for a known principal point. Returns nothing if all boards are parallel
/// to the image.
std::optional<Pinhole> zhangFocalLength(const std::vector<Eigen::Matrix3d>& homographies, const vec2& centre);

/// Start values of the intrinsics, and their source.
struct IntrinsicsStart {
  Pinhole pinhole;
  const char* source = "";  ///< a few words for the report
};

/// Returns the candidate that puts the corners nearest to their pixels. Candidates are Zhang's closed form, the focal
/// length for a principal point amid the corners, and guessed focal lengths.
IntrinsicsStart startIntrinsics(const std::vector<PlaneView>& views);

}  // namespace slom::calibration
