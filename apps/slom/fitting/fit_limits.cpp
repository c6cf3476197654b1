#include "fitting/fit_limits.hpp"

#include <algorithm>
#include <csignal>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <slom/optimize/summary.hpp>

#include "error.hpp"

namespace slom::app {

namespace {

volatile std::sig_atomic_t was_interrupted = 0;
const FitLimits* current = nullptr;
struct sigaction before {};

void interrupt(int) {
  was_interrupted = 1;
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  ::sigaction(SIGINT, &usual, nullptr);
}

}  // namespace

void addTimeLimit(CLI::App& command, double& max_seconds) {
  command
      .add_option("--max-seconds", max_seconds,
                  "ends the fit after this time, as Ctrl-C does, with the best values reached;\n0: no limit")
      ->type_name("NUMBER")
      ->capture_default_str();
}

FitLimits::FitLimits(double max_seconds) : max_seconds_(max_seconds) {
  if (!(max_seconds >= 0))
    throw UserError(fmt::format("--max-seconds {}: give a number from 0 on", max_seconds));
  was_interrupted = 0;
  current = this;
  struct sigaction ours {};
  ours.sa_handler = interrupt;
  ::sigemptyset(&ours.sa_mask);
  ::sigaction(SIGINT, &ours, &before);
}

FitLimits::~FitLimits() {
  ::sigaction(SIGINT, &before, nullptr);
  current = nullptr;
}

void FitLimits::applyTo(Options& options) {
  if (current == nullptr) return;
  options.should_stop = [] { return was_interrupted != 0; };
  if (!(current->max_seconds_ > 0)) return;
  const double passed =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - current->start_).count();
  options.max_seconds = std::max(current->max_seconds_ - passed, 1e-3);
}

}  // namespace slom::app
