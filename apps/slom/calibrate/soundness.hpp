// Whether a result can be used: what decides the exit code, and whether files for other programs are written.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Why a result that converged must not be used; empty where it can be.
struct Unsoundness {
  std::string because;   ///< goes on after "not written, because": "images contradict each other"
  std::string sentence;  ///< with the remedy

  bool isNone() const { return because.empty(); }
};
Unsoundness unsoundnessOf(const Result& result);

/// What to do about a finding, in options of the command.
std::string remedyOf(const ImuFinding& finding, const Result& result);

/// The likeliest cause of a fit that failed or fits badly, with the remedy.
std::string causeText(const Result& result);

}  // namespace slom::app::calib
