// The progress of a long task, on a terminal.
#pragma once

#include <mutex>
#include <string>

namespace slom::app::calib {

/// A bar on standard error if that is a terminal. Wipes itself away at the end.
class ProgressBar {
 public:
  ProgressBar(std::string task, std::size_t total, bool is_wanted);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  /// Counts one more as done; callable from any thread.
  void step();

 private:
  void draw() const;

  const std::string task_;
  const std::size_t total_;
  const bool is_shown_;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

}  // namespace slom::app::calib
