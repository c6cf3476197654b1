/// The end of a fit from outside: at its time limit, or on request of the user's program.
#pragma once

#include <chrono>
#include <optional>

#include "slom/base/collective.hpp"
#include "slom/optimize/summary.hpp"

namespace slom {

/// The clock of a fit, which runs from construction. An interruption holds until the end of the fit.
class Interruption {
 public:
  Interruption(const Options& options, const Collective& collective)
      : options_(options), collective_(collective) {}

  /// Returns the reason to end the fit at once, at its present values: that of any process. Calls
  /// Options::should_stop.
  std::optional<StopReason> reason() {
    collective_.agree([this] {
      if (!reason_ && options_.should_stop && options_.should_stop()) reason_ = StopReason::interrupted;
      if (!reason_ && seconds() > options_.max_seconds) reason_ = StopReason::time_limit;
    });
    if (!collective_.isAlone()) {
      const bool is_interrupted = collective_.any(reason_ == StopReason::interrupted);
      const bool is_late = collective_.any(reason_ == StopReason::time_limit);
      if (is_interrupted || is_late)
        reason_ = is_interrupted ? StopReason::interrupted : StopReason::time_limit;
    }
    return reason_;
  }
  /// Records that the observer requests the end.
  void request() {
    if (!reason_) reason_ = StopReason::interrupted;
  }
  /// Returns the time since the fit began [s].
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  const Options& options_;
  const Collective& collective_;
  std::optional<StopReason> reason_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace slom
