#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>

namespace slom::bench {

template <class F>
double secondsOf(const F& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Returns the processor time of all threads of this process; other processes do not count.
template <class F>
double processorSecondsOf(const F& f) {
  const std::clock_t start = std::clock();
  f();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Returns the shortest of seven times, or of fewer if they take more than 2 s in total.
template <class F>
double bestSecondsOf(const F& f) {
  constexpr int repetitions = 7;
  constexpr double enough = 2;
  double best = std::numeric_limits<double>::infinity(), sum = 0;
  for (int i = 0; i < repetitions && sum < enough; ++i) {
    const double seconds = secondsOf(f);
    best = std::min(best, seconds);
    sum += seconds;
  }
  return best;
}

}  // namespace slom::bench
