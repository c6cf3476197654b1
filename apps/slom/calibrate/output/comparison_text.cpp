#include "calibrate/output/comparison_text.hpp"

#include <fmt/format.h>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

/// Returns a line of the table, which begins with `name`.
std::string row(const std::string& name, const ModelTrial& trial, double standard_errors) {
  if (!trial.failure.empty()) return fmt::format("{}   no fit: {}\n", name, oneLine(trial.failure));
  return fmt::format("{}{:>10}{:>13.1f}{:>10.4f}{:>10.4f}{:>14.4f}{:>18.1f}\n", name, trial.unknowns,
                     trial.rss, trial.rss / trial.redundancy, trial.rms_px, trial.heldOutRms(),
                     standard_errors);
}

std::string header(const std::string& title, const std::string& names) {
  return fmt::format("\n{}\n{}{:>10}{:>13}{:>10}{:>10}{:>14}{:>18}\n", title, names, "unknowns", "RSS",
                     "RSS/dof", "RMS px", "predicted px", "behind best [se]");
}

std::string cutShort(const Comparison& comparison) {
  return comparison.cut_short.empty()
             ? ""
             : fmt::format("The comparison was cut short: {}. ", comparison.cut_short);
}

std::string verdict(const Comparison& comparison) {
  const std::string cut_short = cutShort(comparison);
  if (!comparison.chosen) return cut_short.empty() ? "None of the models fits." : cut_short;
  const ModelTrial &chosen = comparison.chosenTrial(), &best = comparison.trials[*comparison.best];
  if (!cut_short.empty())
    return cut_short + fmt::format("Of the models tried, the data support {}.", chosen.model.name());
  std::string text = fmt::format("The data support {}: ", chosen.model.name());
  if (comparison.chosen == comparison.best)
    return text + "it predicts best, and none with fewer parameters comes within two standard errors.";
  return text +
         fmt::format("{} predicts better, but not by more than two standard errors, and has more parameters.",
                     best.model.name());
}

const char* wordsFor(BoardShape shape) {
  return shape == BoardShape::flat   ? "a flat board"
         : shape == BoardShape::bent ? "a bent board"
                                     : "a free board";
}

std::string verdictOnShape(const Comparison& comparison) {
  const std::string cut_short = cutShort(comparison);
  if (!comparison.chosen) return cut_short.empty() ? "None of the shapes can be fitted." : cut_short;
  const BoardShape chosen = comparison.chosenTrial().board_shape;
  if (!cut_short.empty())
    return cut_short + fmt::format("Of the shapes tried, the data support {}.", wordsFor(chosen));
  if (chosen == BoardShape::flat) return "The data support no other board than the stated one.";
  return fmt::format(
      "The data support {}: it predicts other images better than the stated board, by more than two "
      "standard errors.",
      wordsFor(chosen));
}

}  // namespace

std::string comparisonText(const Comparison& comparison) {
  std::string text = header("models compared", fmt::format("  {:<10}{:>10}", "model", "parameters"));
  for (std::size_t i = 0; i < comparison.trials.size(); ++i) {
    const ModelTrial& trial = comparison.trials[i];
    text += row(fmt::format("  {:<10}{:>10}", trial.model.name(), trial.model.parameters().size()), trial,
                comparison.standard_errors[i]);
  }
  return text + bulleted(verdict(comparison));
}

std::string boardShapesText(const Comparison& comparison) {
  std::string text =
      header(fmt::format("shapes of the board compared, with {}", comparison.trials.front().model.name()),
             fmt::format("  {:<20}", "board"));
  for (std::size_t i = 0; i < comparison.trials.size(); ++i) {
    const ModelTrial& trial = comparison.trials[i];
    text += row(fmt::format("  {:<20}", toString(trial.board_shape)), trial, comparison.standard_errors[i]);
  }
  return text + bulleted(verdictOnShape(comparison));
}

std::string noiseText(const NoiseComparison& comparison, const Result& result) {
  std::string text = fmt::format("\nnoise of corners compared\n  {:<20}{:>12}{:>8}   {}\n", "grows with",
                                 "log. gain", "[se]", "sigma in the lower and upper quarter of views");
  for (const NoiseComparison::Trial& trial : comparison.trials) {
    text += fmt::format("  {:<20}{:>12.1f}{:>8.1f}", toString(trial.by), trial.gain, trial.standard_errors);
    for (std::size_t c = 0; c < trial.noise.size() && trial.by != SigmaBy::constant; ++c) {
      text += fmt::format(
          "{}{}{} and {}", c == 0 ? "   " : ", ", trial.noise.size() > 1 ? result.cameras[c].name + " " : "",
          fixedDecimals(trial.noise[c].lower_quarter, 2), fixedDecimals(trial.noise[c].upper_quarter, 2));
    }
    text += "\n";
  }
  return text +
         bulleted(
             comparison.chosen == SigmaBy::constant
                 ? "The noise is constant: residuals of some images do not predict how large those of "
                   "others are."
                 : fmt::format("The noise grows with {}: residuals of some images predict how large those of "
                               "others are, by more than two standard errors.",
                               toString(comparison.chosen)));
}

std::string readoutText(const std::vector<std::optional<ReadoutTrial>>& trials, const Result& result) {
  std::string text = fmt::format("\nreadout of rows\n  {:<20}{:>12}{:>12}{:>14}\n", "camera", "intervals",
                                 "std", "by chance");
  bool is_found = false;
  for (std::size_t c = 0; c < trials.size(); ++c) {
    if (!trials[c]) {
      text += fmt::format("  {:<20}{:>12}\n", result.cameras[c].name, "no motion");
      continue;
    }
    const ReadoutTrial& trial = *trials[c];
    is_found = is_found || trial.isFound();
    text += fmt::format("  {:<20}{:>12.4f}{:>12}{:>14.4f}\n", result.cameras[c].name, trial.readout.value,
                        "+- " + twoDigits(trial.readout.largestStd()), trial.probability);
  }
  return text + bulleted(is_found ? "Rows are read one after the other; the time is estimated."
                                  : "There is no sign that rows are read one after the other.");
}

}  // namespace slom::app::calib
