#include "calibrate/fit/comparison.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "calibrate/camera_models.hpp"
#include "calibrate/fit/calibration.hpp"
#include "calibrate/input/check.hpp"
#include "fitting/fit_limits.hpp"

namespace slom::app::calib {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// Mean logarithm of the ratio of two models' squares over its standard error; 0 for the same model.
double standardErrors(const std::vector<double>& worse, const std::vector<double>& best) {
  std::vector<double> ratios(worse.size());
  for (std::size_t i = 0; i < worse.size(); ++i) ratios[i] = std::log(worse[i] / best[i]);
  const double average = mean(ratios), count = double(ratios.size());
  double square = 0;
  for (const double ratio : ratios) square += (ratio - average) * (ratio - average);
  const double error = std::sqrt(square / (count - 1) / count);
  return average == 0 ? 0 : average / error;
}

ModelTrial fitOne(const Dataset& data, Settings settings, Model model) {
  settings.model = model;
  switch (model) {
    case Model::radial1:
      return tryModel<Radial1<>>(data, settings);
    case Model::opencv4:
      return tryModel<Opencv4<>>(data, settings);
    case Model::opencv5:
      return tryModel<Opencv5<>>(data, settings);
    case Model::opencv8:
      return tryModel<Opencv8<>>(data, settings);
    case Model::fisheye:
      return tryModel<Fisheye<>>(data, settings);
  }
  return {};
}

/// Notes in the comparison when there is no time left to try this one to the end.
ModelTrial tryOne(const Dataset& data, const Settings& settings, Model model, Comparison& comparison) {
  ModelTrial trial;
  trial.model = model;
  std::string reason;
  try {
    FitLimits::requireTime();
    trial = fitOne(data, settings, model);
    if (!trial.failure.empty()) reason = FitLimits::reasonToEnd();
  } catch (const RunEnded& ended) {
    reason = ended.what();
  }
  if (reason.empty()) return trial;
  comparison.cut_short = reason;
  trial.failure = "not tried to the end, " + reason;
  return trial;
}

}  // namespace

double ModelTrial::heldOutRms() const { return std::sqrt(mean(held_out_squares)); }

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
    if (behind <= clearly_worse && is_simpler) comparison.chosen = i;
  }
}

Comparison compareModels(const Dataset& data, const Settings& settings, const std::vector<Model>& models) {
  checkDataset(data);
  Comparison comparison;
  for (const Model model : models) comparison.trials.push_back(tryOne(data, settings, model, comparison));
  judge(comparison);
  return comparison;
}

}  // namespace slom::app::calib
