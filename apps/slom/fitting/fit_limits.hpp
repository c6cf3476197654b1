// What ends a fit early: --max-seconds, and Ctrl-C.
#pragma once

#include <chrono>

namespace CLI {
class App;
}
namespace slom {
struct Options;
}

namespace slom::app {

/// Adds --max-seconds; 0: no limit.
void addTimeLimit(CLI::App& command, double& max_seconds);

/// While it lives, SIGINT ends fits, with the best values reached, instead of the program; a second one ends
/// that. Its time counts from its construction. UserError where `max_seconds` is negative or no number. One
/// at a time.
class FitLimits {
 public:
  explicit FitLimits(double max_seconds);
  ~FitLimits();
  FitLimits(const FitLimits&) = delete;
  FitLimits& operator=(const FitLimits&) = delete;

  /// Gives a fit the limits of the one that lives now, if any.
  static void applyTo(Options& options);

 private:
  double max_seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace slom::app
