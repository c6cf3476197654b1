// Limits of the work, as fits and loops ask for them.
#pragma once

#include <stdexcept>
#include <string>

#include <slom/slom.hpp>

#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// Thrown out of work that is of no use unfinished, and caught by the library; the text is reasonToEnd().
struct WorkEnded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The same settings, whose time counts from now unless they say from when.
Settings started(Settings settings);

/// Gives a fit what is left of the limits.
void applyLimits(const Limits& limits, Options& options);
/// Names the whole limit in the message of such a fit, which knows what was left of it alone.
void nameLimit(const Limits& limits, Summary& summary);
/// `time limit of 5 s reached` or `interrupted`; empty while the work may go on.
std::string reasonToEnd(const Limits& limits);
/// Throws WorkEnded when there is a reason to end.
void requireTime(const Limits& limits);

}  // namespace slom::calibration
