// How far a long task is, on a terminal.
#pragma once

#include <mutex>
#include <string>

namespace slom::app::calib {

/// Draws on standard error, where that is a terminal, and wipes itself away in the end.
class ProgressBar {
 public:
  ProgressBar(std::string task, std::size_t total, bool is_wanted);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  /// One more is done; from any thread.
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
