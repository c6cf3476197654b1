/// Work in a process of its own, so that its peak memory can be measured and a time limit kept.
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
  std::string text;       ///< what the work returned; otherwise why there is nothing
  double peak_bytes = 0;  ///< peak resident memory, including what was shared with this process
};

/// Runs `work` in a copy of this process, which must have no other thread, and waits for its end.
ChildOutcome runInChild(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace slom::bench
