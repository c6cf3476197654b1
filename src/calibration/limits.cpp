#include "calibration/limits.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace slom::calibration {
namespace {

using Clock = std::chrono::steady_clock;

double secondsLeft(const Limits& limits) {
  using Seconds =
      std::chrono::duration<double>;  // two time points of any resolution have a difference in this type
  const Clock::time_point now = Clock::now(), since = limits.since.value_or(now);
  return limits.max_seconds - (Seconds(now.time_since_epoch()) - Seconds(since.time_since_epoch())).count();
}

std::string limitReached(double max_seconds) {
  return fmt::format("time limit of {:g} s reached", max_seconds);
}

}  // namespace

Settings started(Settings settings) {
  if (!settings.limits.since) settings.limits.since = Clock::now();
  return settings;
}

void applyLimits(const Limits& limits, Options& options) {
  constexpr double no_time = 1e-9;  // the estimator takes positive limits only
  options.should_stop = limits.should_stop;
  if (limits.max_seconds > 0) options.max_seconds = std::max(secondsLeft(limits), no_time);
}

void nameLimit(const Limits& limits, Summary& summary) {
  if (summary.stop_reason == StopReason::time_limit) summary.message = limitReached(limits.max_seconds);
}

std::string reasonToEnd(const Limits& limits) {
  if (limits.should_stop && limits.should_stop()) return "interrupted";
  const bool is_over = limits.max_seconds > 0 && secondsLeft(limits) <= 0;
  return is_over ? limitReached(limits.max_seconds) : "";
}

void requireTime(const Limits& limits) {
  if (const std::string reason = reasonToEnd(limits); !reason.empty()) throw WorkEnded(reason);
}

}  // namespace slom::calibration
