/// Camera models by name. A model maps a point in front of a camera to a pixel. docs/calibrate/models.md has the
/// formulas, docs/extending_command.md explains how to add a model.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

struct ModelDefinition;

/// A lens in the form of another program.
struct ForeignLens {
  std::string camera_model, distortion_model;    ///< the names in that program; empty: it needs none
  std::vector<double> intrinsics, distortion{};  ///< in the order of that program
};

/// A camera model; cheap to copy.
class Model {
 public:
  /// Returns the model of this name. Throws DataError [slom.calibration.unknown-model] if there is none.
  explicit Model(std::string_view name);
  /// Creates the model of a definition from the list.
  explicit Model(const ModelDefinition& definition) : definition_(&definition) {}

  /// Returns the name, such as `opencv5`.
  const std::string& name() const;
  /// Returns the names of the parameters, in the model's order.
  const std::vector<std::string>& parameters() const;
  /// Returns the parameters for which numerator and denominator of the model can grow together if the data do not
  /// determine them. In that case a prior keeps them near 0 (Settings::sigma_denominator). Most models have none.
  std::vector<std::string> heldNearZero() const;
  /// Returns the description of a lens with these parameters, in the model's order, for OpenCV; nothing if OpenCV has
  /// no such model.
  std::optional<ForeignLens> forOpencv(const std::vector<double>& parameters) const;
  /// Returns the description for ROS' camera_info.
  std::optional<ForeignLens> forRos(const std::vector<double>& parameters) const;
  /// Returns the description for Kalibr's camchain.
  std::optional<ForeignLens> forKalibr(const std::vector<double>& parameters) const;

  bool operator==(const Model&) const = default;
  /// Returns formulas, limits and names of the model. Used by the library.
  const ModelDefinition& definition() const { return *definition_; }

 private:
  const ModelDefinition* definition_;
};

/// Returns all models.
const std::vector<Model>& allModels();
/// Returns the models that a comparison tries by default, by rising number of parameters.
const std::vector<Model>& comparedModels();

}  // namespace slom::calibration
