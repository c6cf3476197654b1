/// Work in a separate process, to measure its peak memory and to enforce a time limit.
#pragma once

#include <functional>
#include <string>

namespace slom::bench {

struct ChildLimits {
  double seconds = 0;       ///< 0: none
  double memory_bytes = 0;  ///< limit of data, 0: none
};

struct ChildOutcome {
  bool ok = false;
  std::string text;       ///< result of the work, or the reason why there is none
  double peak_bytes = 0;  ///< peak resident memory, including memory shared with this process
};

/// Runs `work` in a copy of this process, which must have no other thread. Waits for its end.
ChildOutcome runInChild(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace slom::bench
