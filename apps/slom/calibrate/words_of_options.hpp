// Errors of the library in the words of the command: remedies name its options, places the lines of its files.
#pragma once

#include <string>

#include "calibrate/settings.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"

namespace slom::app::calib {

/// The sentence of `error`, composed anew from its parts where the remedy is an option or a column of a file.
std::string inWordsOfOptions(const CommandSettings& settings, const DataError& error);

/// Returns the comparison with the failures of its models in the words of the command.
Comparison inWordsOfOptions(const CommandSettings& settings, Comparison comparison);

/// f(), whose errors become UserError.
template <class F>
auto inWordsOfOptions(const CommandSettings& settings, const F& f) {
  try {
    return f();
  } catch (const DataError& error) {
    throw UserError(inWordsOfOptions(settings, error));
  }
}

/// --max-seconds and Ctrl-C.
Limits limitsOf(const FitLimits& limits);

}  // namespace slom::app::calib
