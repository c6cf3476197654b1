// The entries of the list of models: the functions of a camera model that the calibration uses.
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
  bool is_compared;                 ///< whether comparedModels() has it

  StartLens start_lens;  ///< the lens that its start values assume
  /// Returns start values, one in the basin of attraction of each minimum.
  std::vector<Numbers> (*starts)(const Pinhole& pinhole);

  vec2 (*project)(const double* parameters, const vec3& point);
  void (*differentiate)(const double* parameters, const Eigen::Vector3d& point, Lens::Projection& projection);
  Eigen::Matrix3d (*camera_matrix)(const Numbers& parameters);
  Numbers (*distortion)(const Numbers& parameters);
  ForOther for_opencv, for_ros, for_kalibr;
};

}  // namespace slom::calibration
