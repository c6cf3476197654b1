/// The end of a fit from outside: at its time limit, or because the user's program asks for it.
#pragma once

#include <chrono>
#include <optional>

#include "slom/optimize/summary.hpp"

namespace slom {

/// The clock of a fit runs from construction. What has interrupted the fit once holds until its end.
class Interruption {
 public:
  explicit Interruption(const Options& options) : options_(options) {}

  /// Why the fit is to end at once, where it is. Asks Options::should_stop.
  std::optional<StopReason> reason() {
    if (!reason_ && options_.should_stop && options_.should_stop()) reason_ = StopReason::interrupted;
    if (!reason_ && seconds() > options_.max_seconds) reason_ = StopReason::time_limit;
    return reason_;
  }
  /// The observer asks for the end.
  void request() {
    if (!reason_) reason_ = StopReason::interrupted;
  }
  /// Since the fit began.
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  const Options& options_;
  std::optional<StopReason> reason_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace slom
