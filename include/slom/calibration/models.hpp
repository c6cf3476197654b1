/// Camera models by name: how a point in front of a camera becomes a pixel. docs/calibrate.md has their formulas,
/// docs/extending.md says how to add one.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

struct ModelDefinition;

/// A lens as another program describes it.
struct ForeignLens {
  std::string camera_model, distortion_model;    ///< the names that it has there; empty: it needs none
  std::vector<double> intrinsics, distortion{};  ///< in the order of that program
};

/// One of the models. Cheap to copy.
class Model {
 public:
  /// The model of this name. DataError [slom.calibration.unknown-model] if there is none.
  explicit Model(std::string_view name);
  /// A member of the list.
  explicit Model(const ModelDefinition& definition) : definition_(&definition) {}

  /// `opencv5`
  const std::string& name() const;
  /// Names of the parameters, in the model's order.
  const std::vector<std::string>& parameters() const;
  /// The parameters that numerator and denominator of the model let run off together where the data leave them open, so that
  /// a prior keeps them near 0 then (Settings::sigma_denominator); none in most models.
  std::vector<std::string> heldNearZero() const;
  /// The description of a lens with these parameters, in the model's order; nothing where the program has no such model.
  std::optional<ForeignLens> forOpencv(const std::vector<double>& parameters) const;
  /// The same for ROS' camera_info.
  std::optional<ForeignLens> forRos(const std::vector<double>& parameters) const;
  /// The same for Kalibr's camchain.
  std::optional<ForeignLens> forKalibr(const std::vector<double>& parameters) const;

  bool operator==(const Model&) const = default;
  /// Used by the library: formulas, limits and names of the model.
  const ModelDefinition& definition() const { return *definition_; }

 private:
  const ModelDefinition* definition_;
};

/// All of them.
const std::vector<Model>& allModels();
/// The models that a comparison tries by default, by rising number of parameters.
const std::vector<Model>& comparedModels();

}  // namespace slom::calibration
