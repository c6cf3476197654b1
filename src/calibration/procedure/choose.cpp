#include "slom/calibration/choose.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "calibration/fit/lens_constraints.hpp"

namespace slom::calibration {
namespace {

/// Returns about 300 images of a longer recording, spread evenly. Neighbouring images look alike, so more of them say
/// little about a model, and comparing with all takes many minutes.
Dataset forComparison(const Dataset& data) {
  constexpr std::size_t enough = 300;
  const std::vector<int> images = data.images();
  if (images.size() <= 2 * enough) return data;
  constexpr double golden =
      0.6180339887498949;  // steps that fall on no pattern, such as cameras that take turns
  const double part = double(enough) / double(images.size());
  std::set<int> kept;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const double place = golden * double(i);
    if (place - std::floor(place) < part) kept.insert(images[i]);
  }
  return data.withImages([&](int image) { return kept.count(image) > 0; });
}

/// Compares the models. Sets the chosen model in the settings if the choice is open.
Comparison chooseModel(const Dataset& data, Settings& settings, const std::vector<Model>& models,
                       bool is_open, const ChoiceProgress& progress) {
  Comparison comparison = compareModels(data, settings, models);
  if (is_open && comparison.chosen) settings.model = comparison.chosenTrial().model;
  if (progress.models) progress.models(comparison, settings);
  return comparison;
}

// The denominator of a model that has a prior and a board of unknown shape can have the same effect. Fits of both together
// take long, and may not converge.

/// Returns the models to compare again on a board that is not flat, because the residuals of such a board can look like a
/// lens. Keeps a model with a denominator only if it is the chosen one.
std::vector<Model> modelsForBoard(const Model& chosen, std::vector<Model> models) {
  std::erase_if(models, [&](const Model& model) { return hasPrior(model) && !(model == chosen); });
  return models;
}

/// Returns the model with the best prediction that may be combined with a board of unknown shape; nothing if none fits.
std::optional<Model> bestForBoard(const Comparison& comparison) {
  const ModelTrial* best = nullptr;
  for (const ModelTrial& trial : comparison.trials) {
    if (!trial.failure.empty() || hasPrior(trial.model)) continue;
    if (best == nullptr || trial.heldOutRms() < best->heldOutRms()) best = &trial;
  }
  return best != nullptr ? std::optional(best->model) : std::nullopt;
}

/// Compares the shapes of the board. If a model with a denominator was chosen, compares them with the best other model,
/// unless the flat board with the chosen model predicts better than any shape with the other. `settings` get the chosen
/// shape and, if it is not flat, the model that it was compared with.
Comparison chooseBoardShape(const Dataset& data, const std::optional<Comparison>& models, bool is_open,
                            Settings& settings) {
  Settings tried = settings;
  if (is_open && models && models->chosen && hasPrior(settings.model))
    tried.model = bestForBoard(*models).value_or(settings.model);
  Comparison shapes = compareBoardShapes(data, tried);
  const bool is_other = !(tried.model == settings.model);
  if (is_other &&
      (!shapes.chosen || shapes.chosenTrial().heldOutRms() > models->chosenTrial().heldOutRms())) {
    tried.model = settings.model;
    shapes = compareBoardShapes(data, tried);
  }
  if (shapes.chosen) settings.board_shape = shapes.chosenTrial().board_shape;
  if (settings.board_shape != BoardShape::flat) settings.model = tried.model;
  return shapes;
}

}  // namespace

Result calibrateByChoice(const Dataset& data, Settings& settings, const Choices& choices,
                         const ChoiceProgress& progress) {
  const Dataset compared = choices.models.empty() && !choices.board_shape ? Dataset() : forComparison(data);
  std::optional<Comparison> comparison, board_comparison;
  if (!choices.models.empty())
    comparison = chooseModel(compared, settings, choices.models, choices.model, progress);
  if (choices.board_shape) {
    board_comparison = chooseBoardShape(compared, comparison, choices.model, settings);
    if (progress.board_shapes) progress.board_shapes(*board_comparison);
    const std::vector<Model> models = modelsForBoard(settings.model, choices.models);
    if (settings.board_shape != BoardShape::flat && choices.models.size() > 1 && models.size() > 1)
      comparison = chooseModel(compared, settings, models, choices.model, progress);
  }
  if (progress.before_fit) progress.before_fit(settings);
  Result result = calibrate(data, settings, progress.fit);
  std::optional<NoiseComparison> noise;
  if (choices.sigma_by && result.success()) {
    noise = compareNoise(data, result);
    if (progress.noise) progress.noise(*noise, result);
    settings.sigma_by = noise->chosen;
    if (noise->chosen != SigmaBy::constant) result = calibrate(data, settings);
  }
  std::vector<std::optional<ReadoutTrial>> readout;
  if (choices.rolling_shutter && result.success()) {
    readout = compareReadout(data, result);
    if (progress.readout) progress.readout(readout, result);
    settings.rolling_shutter = std::any_of(readout.begin(), readout.end(),
                                           [](const auto& trial) { return trial && trial->isFound(); });
    if (settings.rolling_shutter) result = calibrate(data, settings);
  }
  result.comparison = std::move(comparison);
  result.board_comparison = std::move(board_comparison);
  result.noise_comparison = std::move(noise);
  result.readout_comparison = std::move(readout);
  return result;
}

}  // namespace slom::calibration
