#include "calibrate/detect/progress_bar.hpp"

#include <cstdio>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

namespace slom::app::calib {

ProgressBar::ProgressBar(std::string task, std::size_t total, bool is_wanted)
    : task_(std::move(task)), total_(total), is_shown_(is_wanted && ::isatty(STDERR_FILENO) == 1) {
  if (is_shown_) draw();
}

ProgressBar::~ProgressBar() {
  if (!is_shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
}

void ProgressBar::step() {
  if (!is_shown_) return;
  const std::lock_guard lock(mutex_);
  ++done_;
  draw();
}

void ProgressBar::draw() const {
  constexpr std::size_t width = 30;
  const std::size_t full = done_ * width / total_;
  fmt::print(stderr, "\r{} [{:<{}}] {} of {}", task_, std::string(full, '#'), width, done_, total_);
  std::fflush(stderr);
}

}  // namespace slom::app::calib
