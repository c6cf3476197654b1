#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace slom::bench {

template <class F>
double secondsOf(const F& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The shortest time of seven, of fewer when they take more than two seconds together.
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
