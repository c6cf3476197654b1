// Errors of the library in the words of the command: remedies name its options, places name lines of its files.
#pragma once

#include <string>

#include "calibrate/settings.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"

namespace slom::app::calib {

/// Returns the sentence of `error`, composed again from its parts if the remedy is an option or a column of a file.
std::string inWordsOfOptions(const CommandSettings& settings, const DataError& error);

/// Returns the comparison with the failures of its models in the words of the command.
Comparison inWordsOfOptions(const CommandSettings& settings, Comparison comparison);

/// Returns f(). Turns its errors into UserError.
template <class F>
auto inWordsOfOptions(const CommandSettings& settings, const F& f) {
  try {
    return f();
  } catch (const DataError& error) {
    throw UserError(inWordsOfOptions(settings, error));
  }
}

/// Returns the limits of --max-seconds and Ctrl-C.
Limits limitsOf(const FitLimits& limits);

}  // namespace slom::app::calib
