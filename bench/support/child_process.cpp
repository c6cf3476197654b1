#include "support/child_process.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <poll.h>
#include <system_error>
#include <unistd.h>

#include <sys/resource.h>
#include <sys/wait.h>

namespace slom::bench {

namespace {

void writeAll(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void beChild(const std::function<std::string()>& work, const ChildLimits& limits, int out) {
  if (limits.memory_bytes > 0) {
    const rlimit most{static_cast<rlim_t>(limits.memory_bytes), static_cast<rlim_t>(limits.memory_bytes)};
    setrlimit(RLIMIT_DATA, &most);
  }
  int status = 0;
  std::string text;
  try {
    text = work();
  } catch (const std::bad_alloc&) {
    status = 1;
    text = "ran out of memory";
  } catch (const std::exception& error) {
    status = 1;
    text = error.what();
  }
  writeAll(out, text);
  _exit(status);
}

/// Reads until the other end is closed. Returns false if that takes too long.
bool readAll(int file, double seconds, std::string& text) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  char buffer[1 << 16];
  for (;;) {
    int timeout_ms = -1;
    if (seconds > 0) {
      const double left = std::chrono::duration<double, std::milli>(end - Clock::now()).count();
      if (left <= 0) return false;
      timeout_ms = static_cast<int>(left) + 1;
    }
    pollfd wanted{file, POLLIN, 0};
    if (poll(&wanted, 1, timeout_ms) <= 0) continue;
    const ssize_t count = read(file, buffer, sizeof buffer);
    if (count == 0) return true;
    if (count > 0) text.append(buffer, static_cast<std::size_t>(count));
  }
}

std::string reasonOf(int status, const std::string& text) {
  if (WIFEXITED(status)) return text.empty() ? "ended without a result" : text;
  return "ended by signal " + std::to_string(WTERMSIG(status));
}

}  // namespace

ChildOutcome runInChild(const std::function<std::string()>& work, const ChildLimits& limits) {
  std::fflush(nullptr);
  int ends[2];
  if (pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    close(ends[0]);
    beChild(work, limits, ends[1]);
  }
  close(ends[1]);
  ChildOutcome outcome;
  const bool in_time = readAll(ends[0], limits.seconds, outcome.text);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  outcome.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  outcome.ok = in_time && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (!in_time) {
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%g", limits.seconds);
    outcome.text = std::string("took more than ") + seconds + " s";
  } else if (!outcome.ok) {
    outcome.text = reasonOf(status, outcome.text);
  }
  return outcome;
}

}  // namespace slom::bench
