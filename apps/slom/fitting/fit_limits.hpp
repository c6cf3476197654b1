// What ends a run early: --max-seconds, and Ctrl-C.
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

/// UserError where the value of --max-seconds is negative or not a number. Called before any file is read.
void requireTimeLimit(double max_seconds);

/// Thrown to end work that is useless when unfinished; the text is FitLimits::reasonToEnd().
struct RunEnded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// While an object lives, the first SIGINT ends the work with the best values reached, the second one ends the program; where
/// SIGINT was ignored before, it stays ignored. The time limit counts from construction. There is at most one object at a time.
class FitLimits {
 public:
  /// What SIGINT does until catchInterrupts() is called.
  enum class Interrupts { end_the_work, end_the_program };

  explicit FitLimits(double max_seconds, Interrupts interrupts = Interrupts::end_the_work);
  ~FitLimits();
  FitLimits(const FitLimits&) = delete;
  FitLimits& operator=(const FitLimits&) = delete;

  /// From now on SIGINT ends the work.
  void catchInterrupts();

  double maxSeconds() const { return max_seconds_; }
  /// When the time limit began to count.
  std::chrono::steady_clock::time_point start() const { return start_; }
  /// Whether SIGINT arrived after the latest object was made.
  static bool wasInterrupted();

  /// Gives a fit the limits of the object that lives now, if any.
  static void applyTo(Options& options);
  /// Puts the limit that the user gave into the message of such a fit, which names the time that was left instead.
  static void nameIn(Summary& summary);
  /// Makes the summary that of a fit which a limit has ended, whatever else it says.
  static void sayIn(Summary& summary);
  /// `time limit of 5 s reached` or `interrupted`; empty while the work may go on.
  static std::string reasonToEnd();
  /// Throws RunEnded when there is a reason to end.
  static void requireTime();

 private:
  double secondsLeft() const;

  double max_seconds_;
  bool catches_interrupts_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace slom::app
