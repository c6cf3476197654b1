// Errors of the library in the words of the command: remedies name its options, places the lines of its files.
#pragma once

#include <string>

#include "calibrate/settings.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"

namespace slom::app::calib {

/// Of an error with this id and sentence; as it is, where the id is of none that the command says otherwise.
std::string inWordsOfOptions(const CommandSettings& settings, const std::string& id, std::string sentence);

/// f(), whose errors become UserError.
template <class F>
auto inWordsOfOptions(const CommandSettings& settings, const F& f) {
  try {
    return f();
  } catch (const DataError& error) {
    throw UserError(inWordsOfOptions(settings, error.id(), std::string(error.sentence())));
  }
}

/// --max-seconds and Ctrl-C.
Limits limitsOf(const FitLimits& limits);

}  // namespace slom::app::calib
