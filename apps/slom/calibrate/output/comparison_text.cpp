#include "calibrate/output/comparison_text.hpp"

#include <fmt/format.h>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

std::string row(const ModelTrial& trial, double standard_errors) {
  const std::string name = fmt::format("  {:<10}{:>10}", trial.model.name(), trial.model.parameters().size());
  if (!trial.failure.empty()) return fmt::format("{}   no fit: {}\n", name, oneLine(trial.failure));
  return fmt::format("{}{:>10}{:>13.1f}{:>10.4f}{:>10.4f}{:>14.4f}{:>18.1f}\n", name, trial.unknowns,
                     trial.rss, trial.rss / trial.redundancy, trial.rms_px, trial.heldOutRms(),
                     standard_errors);
}

std::string verdict(const Comparison& comparison) {
  const std::string cut_short = comparison.cut_short.empty()
                                    ? ""
                                    : fmt::format("The comparison was cut short: {}. ", comparison.cut_short);
  if (!comparison.chosen) return cut_short.empty() ? "None of the models fits." : cut_short;
  const ModelTrial &chosen = comparison.chosenTrial(), &best = comparison.trials[*comparison.best];
  if (!cut_short.empty())
    return cut_short + fmt::format("Of the models tried, the data carry {}.", chosen.model.name());
  std::string text = fmt::format("The data carry {}: ", chosen.model.name());
  if (comparison.chosen == comparison.best)
    return text + "it predicts best, and none with fewer parameters comes within two standard errors.";
  return text +
         fmt::format("{} predicts better, but not by more than two standard errors, and has more parameters.",
                     best.model.name());
}

}  // namespace

std::string comparisonText(const Comparison& comparison) {
  std::string text =
      fmt::format("\nmodels compared\n  {:<10}{:>10}{:>10}{:>13}{:>10}{:>10}{:>14}{:>18}\n", "model",
                  "parameters", "unknowns", "RSS", "RSS/dof", "RMS px", "predicted px", "behind best [se]");
  for (std::size_t i = 0; i < comparison.trials.size(); ++i)
    text += row(comparison.trials[i], comparison.standard_errors[i]);
  return text + bulleted(verdict(comparison));
}

}  // namespace slom::app::calib
