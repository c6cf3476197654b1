// Values of a fit in a folder while it runs, from which a later run goes on.
#pragma once

#include <chrono>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include <slom/base/collective.hpp>
#include <slom/optimize/summary.hpp>

#include "error.hpp"

namespace slom::app {

/// Folders with values of a fit.
struct CheckpointOptions {
  std::string write_to;     ///< empty: none
  std::string resume_from;  ///< empty: from the file
  double minutes = 0;       ///< between two checkpoints; 0: after every iteration
};

/// Adds --checkpoint, --checkpoint-minutes and --resume.
void addCheckpointOptions(CLI::App& command, CheckpointOptions& options);
/// Throws UserError for values that make no sense.
void checkCheckpointOptions(const CheckpointOptions& options);

/// Writes checkpoints while a fit runs.
class CheckpointClock {
 public:
  /// `write` writes the values of the moment, in all processes together. Refers to `options` and `processes`, which must
  /// outlive this object.
  CheckpointClock(const CheckpointOptions& options, const Collective& processes, std::function<void()> write)
      : options_(options), processes_(processes), write_(std::move(write)) {}

  /// Writes after the observer of the options, in each iteration in which it is time. Does nothing without --checkpoint.
  /// Refers to this object.
  void follow(Options& options);
  /// Writes the values of the end, unless the last iteration wrote them.
  void finish();

 private:
  void afterIteration();

  const CheckpointOptions& options_;
  const Collective& processes_;
  std::function<void()> write_;
  std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
  bool is_due_ = false;  // values have changed since the last checkpoint
};

/// Takes a value from bytes of a checkpoint. Throws UserError if they are of another type.
template <class T>
void takeValue(std::string_view bytes, T& value) {
  if (bytes.size() != sizeof value)
    throw UserError(
        "--resume: the checkpoint was written by another version of slom; begin again without it");
  std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof value);
}

}  // namespace slom::app
