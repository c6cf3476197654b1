// The corners of each image, condensed: so many numbers as there are unknowns, instead of two for each corner.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "calibration/initialization/rig.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Values of the cameras: lenses, poses on the rig, and the pose of the rig at each image.
struct CamerasAt {
  std::vector<Lens> lenses;
  RigStart rig;
};
/// Returns the values of the cameras' own fit.
CamerasAt valuesOf(const Result& cameras);

/// The corners of an image, linearised: |R d + b|^2 is the sum of their squared residuals for a step d from the point of
/// linearisation, but for a constant. Corners have a standard deviation of Corner::sigma px.
///   columns  pose left2world (6), lenses of `cameras`, left2camera of `cameras` but the reference (6 each)
struct CondensedImage {
  std::vector<std::size_t> cameras;  ///< that see the image
  Eigen::MatrixXd R;
  Eigen::VectorXd b;
};

/// All images, linearised at one point. Gauss-Newton steps on them are those on the corners.
struct CondensedCorners {
  CamerasAt point;
  std::map<int, CondensedImage> images{};
  std::size_t corners = 0;

  /// Returns whether all cameras see the board at the point.
  bool isFinite() const {
    return std::all_of(images.begin(), images.end(), [](const auto& image) {
      return image.second.R.allFinite() && image.second.b.allFinite();
    });
  }
};
CondensedCorners condensed(const Dataset& data, CamerasAt point);

}  // namespace slom::calibration
