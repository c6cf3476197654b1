// Limits on the work of fits and loops.
#pragma once

#include <stdexcept>
#include <string>

#include <slom/slom.hpp>

#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// Thrown to end work whose partial result has no use; caught by the library. The text is reasonToEnd().
struct WorkEnded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns the settings with limits.since set to now, unless it is set.
Settings started(Settings settings);

/// Sets the options of one fit to what remains of the limits.
void applyLimits(const Limits& limits, Options& options);
/// Replaces the summary's message after a time limit: names the whole limit, not the rest that the fit was given.
void nameLimit(const Limits& limits, Summary& summary);
/// Returns `time limit of 5 s reached` or `interrupted`; empty if the work may go on.
std::string reasonToEnd(const Limits& limits);
/// Throws WorkEnded if reasonToEnd() gives a reason.
void requireTime(const Limits& limits);

}  // namespace slom::calibration
