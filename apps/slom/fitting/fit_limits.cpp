#include "fitting/fit_limits.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <slom/optimize/summary.hpp>

#include "error.hpp"
#include "processes.hpp"

namespace slom::app {

namespace {

/// Set by the signal, read by the threads of the run.
std::atomic<int> was_interrupted = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // as a signal needs it
const FitLimits* current = nullptr;
/// Signals that end a fit. mpirun turns Ctrl-C into SIGTERM and passes on SIGUSR1, so several processes take these, too.
constexpr std::array<int, 3> ending_signals{SIGINT, SIGTERM, SIGUSR1};
struct sigaction before[ending_signals.size()];
std::size_t caught = 0;  // number of the first signals that are caught

void restoreSignals() {
  for (std::size_t i = 0; i < caught; ++i) ::sigaction(ending_signals[i], &before[i], nullptr);
}

void interrupt(int) {
  was_interrupted = 1;
  restoreSignals();
}

std::string limitReached(double max_seconds) {
  return fmt::format("time limit of {:g} s reached", max_seconds);
}

}  // namespace

void addTimeLimit(CLI::App& command, double& max_seconds) {
  command
      .add_option("--max-seconds", max_seconds,
                  "stop after this time, as Ctrl-C does, with the best values; 0: never")
      ->type_name("NUMBER")
      ->capture_default_str();
}

void requireTimeLimit(double max_seconds) {
  if (!(max_seconds >= 0))
    throw UserError(fmt::format("--max-seconds {}: give a number from 0 on", max_seconds));
}

FitLimits::FitLimits(double max_seconds, Interrupts interrupts) : max_seconds_(max_seconds) {
  was_interrupted = 0;
  current = this;
  if (interrupts == Interrupts::end_the_work) catchInterrupts();
}

FitLimits::~FitLimits() {
  if (catches_interrupts_) restoreSignals();
  caught = 0;
  current = nullptr;
}

void FitLimits::catchInterrupts() {
  if (::sigaction(SIGINT, nullptr, &before[0]) != 0 || before[0].sa_handler == SIG_IGN) return;
  struct sigaction ours {};
  ours.sa_handler = interrupt;
  ::sigemptyset(&ours.sa_mask);
  const std::size_t count = processCount() > 1 ? ending_signals.size() : 1;
  for (std::size_t i = 0; i < count; ++i) {
    if (::sigaction(ending_signals[i], &ours, &before[i]) != 0) break;
    caught = i + 1;
  }
  catches_interrupts_ = caught > 0;
}

bool FitLimits::wasInterrupted() { return was_interrupted != 0; }

double FitLimits::secondsLeft() const {
  return max_seconds_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void FitLimits::applyTo(Options& options) {
  constexpr double no_time = 1e-9;  // the library requires a positive number
  if (current == nullptr) return;
  options.should_stop = [] { return was_interrupted != 0; };
  if (current->max_seconds_ > 0) options.max_seconds = std::max(current->secondsLeft(), no_time);
}

void FitLimits::nameIn(Summary& summary) {
  if (current == nullptr || summary.stop_reason != StopReason::time_limit) return;
  summary.message = limitReached(current->max_seconds_);
}

void FitLimits::sayIn(Summary& summary) {
  summary.converged = false;
  summary.stop_reason = wasInterrupted() ? StopReason::interrupted : StopReason::time_limit;
  summary.message = reasonToEnd();
}

std::string FitLimits::reasonToEnd() {
  if (current == nullptr) return {};
  if (was_interrupted != 0) return "interrupted";
  const bool is_over = current->max_seconds_ > 0 && current->secondsLeft() <= 0;
  return is_over ? limitReached(current->max_seconds_) : "";
}

void FitLimits::requireTime() {
  if (const std::string reason = reasonToEnd(); !reason.empty()) throw RunEnded(reason);
}

}  // namespace slom::app
