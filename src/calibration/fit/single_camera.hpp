// A camera by itself: intrinsics and the pose of each of its views.
#pragma once

#include <string>
#include <vector>

#include "calibration/initialization/rig.hpp"
#include "calibration/initialization/view_pose.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Tolerance of fits whose results start other fits: five digits of the RMS.
inline constexpr double rough_tolerance = 1e-6;
/// Largest distance from the solution at which fits end, in standard deviations. Printed values have no more digits.
inline constexpr double enough_deviations = 1e-4;
/// The same for fits of which only large residuals matter.
inline constexpr double rough_deviations = 0.05;

struct FitAlone {
  Lens camera;
  ViewPoses world2camera{};
  bool converged = false;  ///< false: camera and poses are start values
  int iterations = 0;
  double rms_px = unknown;
  std::string start{};  ///< how the intrinsics were found, in a few words
};

/// Returns the sum of squared distances between corners and pixels [px^2]; infinity if a corner has no image, for
/// example behind the camera.
double squaredPixelError(const Lens& camera, const SE3& world2camera, const View& view);

/// Returns the median of the distances between corners and pixels [px]; infinity if the median corner has no image.
double medianPixelError(const Lens& camera, const SE3& world2camera, const View& view);

/// Fits one camera to its views as planes: start values, then all unknowns together. Keeps the best of several
/// starts.
FitAlone fitAlone(const CameraData& data, std::vector<PlaneView> planes, const Settings& settings);

}  // namespace slom::calibration
