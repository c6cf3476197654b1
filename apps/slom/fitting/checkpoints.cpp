#include "fitting/checkpoints.hpp"

#include <utility>

#include <fmt/format.h>

namespace slom::app {

void addCheckpointOptions(CLI::App& command, CheckpointOptions& options) {
  command
      .add_option("--checkpoint", options.write_to,
                  "folder for the values of each iteration, which --resume reads")
      ->type_name("DIR");
  command
      .add_option("--checkpoint-minutes", options.minutes,
                  "write to it only every so many minutes, and at the end")
      ->type_name("NUMBER");
  command
      .add_option("--resume", options.resume_from,
                  "go on from the values in this folder, with any number of processes")
      ->type_name("DIR");
}

void checkCheckpointOptions(const CheckpointOptions& options) {
  if (!(options.minutes >= 0))
    throw UserError(fmt::format("--checkpoint-minutes {}: give a number from 0 on; 0: after every iteration",
                                options.minutes));
  if (options.minutes > 0 && options.write_to.empty())
    throw UserError(
        fmt::format("--checkpoint-minutes {}: no folder is given; add --checkpoint DIR or drop this option",
                    options.minutes));
}

void CheckpointClock::follow(Options& options) {
  if (options_.write_to.empty()) return;
  options.observer = [this, before = options.observer](const IterationRecord& record) {
    const FitControl control = before ? before(record) : FitControl::go_on;
    afterIteration();
    return control;
  };
}

void CheckpointClock::afterIteration() {
  const double minutes =
      std::chrono::duration<double, std::ratio<60>>(std::chrono::steady_clock::now() - written_).count();
  is_due_ = true;
  if (processes_.any(minutes >= options_.minutes)) finish();
}

void CheckpointClock::finish() {
  if (!is_due_) return;
  write_();
  written_ = std::chrono::steady_clock::now();
  is_due_ = false;
}

}  // namespace slom::app
