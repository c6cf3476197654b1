#include "slom/calibration/comparison.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "calibration/data/check.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/well_formed.hpp"
#include "calibration/fit/model_fit.hpp"
#include "calibration/initialization/far_off.hpp"
#include "calibration/limits.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/procedure/judge.hpp"

namespace slom::calibration {
namespace {

/// A model behind the best by more standard errors than this is clearly worse. One would be too few, because the
/// images of a fold share one fitted lens: in one of five simulations it chose a parameter that is 0 in truth.
constexpr double clearly_worse_errors = 2;

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// Returns the mean logarithm of the ratio of two models' squares, divided by its standard error; 0 for the same
/// model.
double standardErrors(const std::vector<double>& worse, const std::vector<double>& best) {
  std::vector<double> ratios(worse.size());
  for (std::size_t i = 0; i < worse.size(); ++i) ratios[i] = std::log(worse[i] / best[i]);
  const double average = mean(ratios), count = double(ratios.size());
  double square = 0;
  for (const double ratio : ratios) square += (ratio - average) * (ratio - average);
  const double error = std::sqrt(square / (count - 1) / count);
  return average == 0 ? 0 : average / error;
}

/// Tries one model. If the time ends before the trial does, notes the reason in the comparison.
ModelTrial tryOne(const Dataset& data, const Settings& settings, Comparison& comparison) {
  ModelTrial trial{settings.model, settings.board_shape};
  std::string reason;
  try {
    requireTime(settings.limits);
    trial = tryModel(data, settings);
    if (!trial.failure.empty()) reason = reasonToEnd(settings.limits);
  } catch (const WorkEnded& ended) {
    reason = ended.what();
  }
  if (reason.empty()) return trial;
  comparison.cut_short = reason;
  trial.failure = "not tried to the end: " + reason;
  trial.error.reset();
  return trial;
}

}  // namespace

double ModelTrial::heldOutRms() const { return std::sqrt(mean(held_out_squares)); }

const ModelTrial& Comparison::chosenTrial() const {
  if (chosen && *chosen < trials.size()) return trials[*chosen];
  throw DataError(
      "slom.calibration.no-result",
      "no model is chosen, because none of the tried models fits; check Comparison::chosen first, and see "
      "ModelTrial::failure",
      "chosen");
}

void judge(Comparison& comparison) {
  const auto& trials = comparison.trials;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (!trials[i].failure.empty()) continue;
    if (!comparison.best || trials[i].heldOutRms() < trials[*comparison.best].heldOutRms())
      comparison.best = i;
  }
  comparison.standard_errors.assign(trials.size(), std::numeric_limits<double>::quiet_NaN());
  if (!comparison.best) return;
  const ModelTrial& best = trials[*comparison.best];
  comparison.chosen = comparison.best;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (!trials[i].failure.empty()) continue;
    const double behind = standardErrors(trials[i].held_out_squares, best.held_out_squares);
    comparison.standard_errors[i] = behind;
    const ModelTrial& chosen = comparison.chosenTrial();
    const bool is_simpler =
        trials[i].unknowns < chosen.unknowns ||
        (trials[i].unknowns == chosen.unknowns && trials[i].heldOutRms() < chosen.heldOutRms());
    if (behind <= clearly_worse_errors && is_simpler) comparison.chosen = i;
  }
}

namespace {

Comparison compareAll(const Dataset& data, const std::vector<Settings>& alternatives) {
  for (const Settings& settings : alternatives) checkSettings(data, settings);
  requireWellFormed(data);
  const SortedDataset sorted(data);
  checkDataset(*sorted);
  Result without;
  if (alternatives.front().robust != Robust::none) without.rejected = farOffCorners(*sorted);
  const Dataset accepted = withoutRejected(*sorted, without);
  Comparison comparison;
  const Limits limits = started(alternatives.front()).limits;
  for (Settings settings : alternatives) {
    settings.limits = limits;
    comparison.trials.push_back(tryOne(accepted, settings, comparison));
  }
  judge(comparison);
  return comparison;
}

}  // namespace

Comparison compareModels(const Dataset& data, const Settings& settings, const std::vector<Model>& models) {
  if (models.empty()) {
    throw DataError("slom.calibration.bad-settings",
                    "there is no model to compare; pass some, such as comparedModels()", "models");
  }
  std::vector<Settings> alternatives(models.size(), settings);
  for (std::size_t i = 0; i < models.size(); ++i) alternatives[i].model = models[i];
  return compareAll(data, alternatives);
}

Comparison compareBoardShapes(const Dataset& data, const Settings& settings) {
  std::vector<Settings> alternatives(3, settings);
  alternatives[0].board_shape = BoardShape::flat;
  alternatives[1].board_shape = BoardShape::bent;
  alternatives[2].board_shape = BoardShape::free;
  return compareAll(data, alternatives);
}

}  // namespace slom::calibration
