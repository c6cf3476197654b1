// Limits that end a run early: --max-seconds, and Ctrl-C.
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}
namespace slom {
struct Options;
struct Summary;
}  // namespace slom

namespace slom::app {

/// Adds --max-seconds; 0: no limit.
void addTimeLimit(CLI::App& command, double& max_seconds);

/// Throws UserError if the value of --max-seconds is negative or not a number. Called before any file is read.
void requireTimeLimit(double max_seconds);

/// An exception that ends work that is useless when unfinished. Its text is FitLimits::reasonToEnd().
struct RunEnded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Limits in force during an object's lifetime. The first SIGINT ends the work with the best values reached, the second
/// ends the program. On several processes, so do SIGTERM and SIGUSR1. If SIGINT was ignored before, all stay as they
/// were. The time limit counts from construction. There is at most one object at a time.
class FitLimits {
 public:
  /// Effect of SIGINT until catchInterrupts() is called.
  enum class Interrupts { end_the_work, end_the_program };

  explicit FitLimits(double max_seconds, Interrupts interrupts = Interrupts::end_the_work);
  ~FitLimits();
  FitLimits(const FitLimits&) = delete;
  FitLimits& operator=(const FitLimits&) = delete;

  /// Makes SIGINT end the work from now on.
  void catchInterrupts();

  double maxSeconds() const { return max_seconds_; }
  /// Returns the time at which the time limit began to count.
  std::chrono::steady_clock::time_point start() const { return start_; }
  /// Returns whether SIGINT arrived after the latest object was made.
  static bool wasInterrupted();

  /// Gives a fit the limits of the present object, if there is one.
  static void applyTo(Options& options);
  /// Writes the user's limit into the message of such a fit, in place of the remaining time.
  static void nameIn(Summary& summary);
  /// Turns the summary into that of a fit ended by a limit, whatever else it says.
  static void sayIn(Summary& summary);
  /// Returns `time limit of 5 s reached` or `interrupted`; empty while the work may continue.
  static std::string reasonToEnd();
  /// Throws RunEnded if there is a reason to end.
  static void requireTime();

 private:
  double secondsLeft() const;

  double max_seconds_;
  bool catches_interrupts_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace slom::app
