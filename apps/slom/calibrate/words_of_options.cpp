#include "calibrate/words_of_options.hpp"

#include <map>
#include <vector>

#include <fmt/format.h>

namespace slom::app::calib {
namespace {

std::string tooFewData(const CommandSettings& settings, const DataError::Parts& parts) {
  // The rows of a corner file begin below its header, line 1.
  return fmt::format(
      "{}{}: {}; add images or corners, or choose a model with fewer parameters by --intrinsics", parts.place,
      settings.board ? "" : ":2", parts.fault);
}

std::string imuOpen(const CommandSettings&, const DataError::Parts& parts) {
  const auto option_for = [](const std::string& name) {
    return name == "gravity" ? std::string("--fix gravity=9.81") : "--fix " + name;
  };
  std::string sentence = fmt::format("{}: {}; {}", parts.place, parts.fault, parts.remedy);
  for (const std::vector<std::string>& names : parts.worth_fixing) {
    sentence += ", or pass";
    for (const std::string& name : names) sentence += " " + option_for(name);
  }
  return sentence;
}

std::string imuImages(const CommandSettings&, const DataError::Parts& parts) {
  return fmt::format("{}: {}; correct the number, or set valid to 0", parts.place, parts.fault);
}

std::string nothingToExclude(const CommandSettings&, const DataError::Parts& parts) {
  const std::string what = parts.place.substr(parts.place.find(' ') + 1);
  return fmt::format("--exclude {}: {}; {}", what, parts.fault, parts.remedy);
}

std::string noStart(const CommandSettings& settings, const DataError::Parts& parts) {
  if (settings.robust != Robust::none)
    return fmt::format("{}: {}; {}", parts.place, parts.fault, parts.remedy);
  return fmt::format("{}: {}; look for corners that are far off, or leave them out by --robust reject",
                     parts.place, parts.fault);
}

std::string noBoard(const CommandSettings& settings, const DataError::Parts& parts) {
  const bool has_size = settings.board_of_files && settings.board_of_files->columns > 0;
  const bool needs_size = !has_size && parts.fault.find("how many corners") != std::string::npos;
  const bool needs_square = !(settings.board_of_files && settings.board_of_files->square_m > 0);
  return fmt::format("{}: {}; pass {}", parts.place, parts.fault,
                     needs_size && needs_square
                         ? "--board COLUMNSxROWS, its inner corners, and --square METRES"
                     : needs_size ? "--board COLUMNSxROWS, its inner corners"
                                  : "--square METRES");
}

/// Words an error about a view. Names exchanged rows and columns of --board.
std::string badView(const CommandSettings& settings, const DataError::Parts& parts) {
  const bool is_exchanged = settings.board_of_files && settings.board_of_files->columns > 0 &&
                            parts.fault.find("rows and columns are exchanged") != std::string::npos;
  const std::string remedy = is_exchanged ? fmt::format("give --board {}x{}", settings.board_of_files->rows,
                                                        settings.board_of_files->columns)
                                          : std::string(parts.remedy);
  return fmt::format("{}: {}; {}", parts.place, parts.fault, remedy);
}

std::string unusedBoard(const CommandSettings& settings, const DataError::Parts& parts) {
  return fmt::format("{}: {}; drop {}", parts.place, parts.fault,
                     settings.board_of_files->columns > 0 ? "--board" : "--square");
}

}  // namespace

std::string inWordsOfOptions(const CommandSettings& settings, const DataError& error) {
  using Sentence = std::string (*)(const CommandSettings&, const DataError::Parts&);
  static const std::map<std::string, Sentence> sentences{
      {"slom.calibration.too-few-data", &tooFewData},
      {"slom.calibration.nothing-to-exclude", &nothingToExclude},
      {"slom.calibration.imu-open", &imuOpen},
      {"slom.calibration.no-start", &noStart},
      {"slom.calibration.no-board", &noBoard},
      {"slom.calibration.bad-view", &badView},
      {"slom.calibration.unused-board", &unusedBoard},
      {"slom.calibration.imu-images", &imuImages}};
  const auto found = sentences.find(error.id());
  return found == sentences.end() || error.parts().fault.empty() ? std::string(error.sentence())
                                                                 : found->second(settings, error.parts());
}

Comparison inWordsOfOptions(const CommandSettings& settings, Comparison comparison) {
  for (ModelTrial& trial : comparison.trials) {
    if (trial.error) trial.failure = inWordsOfOptions(settings, *trial.error);
  }
  return comparison;
}

Limits limitsOf(const FitLimits& limits) {
  return {limits.maxSeconds(), limits.start(), &FitLimits::wasInterrupted};
}

}  // namespace slom::app::calib
