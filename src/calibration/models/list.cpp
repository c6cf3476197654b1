#include <algorithm>

#include <fmt/format.h>

#include "calibration/models/definition.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {

namespace models {
#define SLOM_CALIBRATION_MODEL(name) const ModelDefinition& name();
#include "calibration/models/list.inc"
#undef SLOM_CALIBRATION_MODEL
}  // namespace models

const std::vector<Model>& allModels() {
  static const std::vector<Model> all{
#define SLOM_CALIBRATION_MODEL(name) Model(models::name()),
#include "calibration/models/list.inc"
#undef SLOM_CALIBRATION_MODEL
  };
  return all;
}

const std::vector<Model>& comparedModels() {
  static const std::vector<Model> compared = [] {
    std::vector<Model> models;
    for (const Model& model : allModels()) {
      if (model.definition().is_compared) models.push_back(model);
    }
    std::stable_sort(models.begin(), models.end(), [](const Model& a, const Model& b) {
      return a.parameters().size() < b.parameters().size();
    });
    return models;
  }();
  return compared;
}

namespace {

void requireParameters(const Model& model, const std::vector<double>& parameters) {
  if (parameters.size() == model.parameters().size()) return;
  throw DataError(
      "slom.calibration.bad-question",
      fmt::format(
          "the number of parameters is {} instead of {} for the model {}; pass all of them, in the order "
          "of Model::parameters()",
          parameters.size(), model.parameters().size(), model.name()),
      "parameters");
}

}  // namespace

Model::Model(std::string_view name) {
  std::string names;
  const std::vector<Model>& all = allModels();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name() == name) {
      definition_ = all[i].definition_;
      return;
    }
    names += (i == 0 ? "" : i + 1 < all.size() ? ", " : " and ") + all[i].name();
  }
  throw DataError("slom.calibration.unknown-model", std::string(name) + ": the models are " + names,
                  std::string(name));
}

const std::string& Model::name() const { return definition_->name; }
const std::vector<std::string>& Model::parameters() const { return definition_->parameters; }
std::vector<std::string> Model::heldNearZero() const {
  std::vector<std::string> names;
  for (const int i : definition_->held_near_zero) names.push_back(parameters()[std::size_t(i)]);
  return names;
}

std::optional<ForeignLens> Model::forOpencv(const std::vector<double>& parameters) const {
  requireParameters(*this, parameters);
  return definition_->for_opencv(parameters);
}
std::optional<ForeignLens> Model::forRos(const std::vector<double>& parameters) const {
  requireParameters(*this, parameters);
  return definition_->for_ros(parameters);
}
std::optional<ForeignLens> Model::forKalibr(const std::vector<double>& parameters) const {
  requireParameters(*this, parameters);
  return definition_->for_kalibr(parameters);
}

}  // namespace slom::calibration
