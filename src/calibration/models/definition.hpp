// What the calibration knows of a camera model: the entries of the list.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/models/camera.hpp"
#include "calibration/models/lens.hpp"

namespace slom::calibration {

struct ModelDefinition {
  using Numbers = std::vector<double>;
  using ForOther = std::optional<ForeignLens> (*)(const Numbers& parameters);

  std::string name;
  std::vector<std::string> parameters;
  std::vector<int> held_near_zero;  ///< parameters of the prior Settings::sigma_denominator
  bool is_compared;                 ///< it is in comparedModels()

  StartLens start_lens;  ///< which lens its start values take it for
  /// Start values, one in the basin of attraction of each minimum.
  std::vector<Numbers> (*starts)(const Pinhole& pinhole);

  vec2 (*project)(const double* parameters, const vec3& point);
  void (*differentiate)(const double* parameters, const Eigen::Vector3d& point, Lens::Projection& projection);
  Eigen::Matrix3d (*camera_matrix)(const Numbers& parameters);
  Numbers (*distortion)(const Numbers& parameters);
  ForOther for_opencv, for_ros, for_kalibr;
};

}  // namespace slom::calibration
