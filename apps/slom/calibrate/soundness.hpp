// Whether a result is usable. This decides the exit code, and whether files for other programs are written.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// The reason why a converged result must not be used; empty if it can be used.
struct Unsoundness {
  std::string because;   ///< continues "not written, because": "images contradict each other"
  std::string sentence;  ///< with the remedy

  bool isNone() const { return because.empty(); }
};
Unsoundness unsoundnessOf(const Result& result);

/// Returns what to do about a finding, in options of the command.
std::string remedyOf(const ImuFinding& finding, const Result& result);

/// Returns the likeliest cause of a fit that failed or fits badly, with the remedy.
std::string causeText(const Result& result);

}  // namespace slom::app::calib
