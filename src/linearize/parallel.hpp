/// Loops whose work is shared by the threads of the arena that they run in.
#pragma once

#include <algorithm>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace slom::detail {

/// Runs f(0) ... f(count - 1), each once.
template <class F>
void forEachIndex(int count, const F& f) {
  if (count <= 1 || tbb::this_task_arena::max_concurrency() == 1) {
    for (int i = 0; i < count; ++i) f(i);
  } else {
    tbb::parallel_for(0, count, f);
  }
}

/// Cuts [0, n) into `parts` ranges of about the same work and runs f(first, last) for each. work: n + 1 entries, that of
/// all indices before each.
template <class F>
void forEachRange(const std::vector<double>& work, int parts, const F& f) {
  const auto begin = [&](int part) {
    const auto found = std::lower_bound(work.begin(), work.end(), work.back() * part / parts);
    return static_cast<int>((part == parts ? work.end() - 1 : found) - work.begin());
  };
  forEachIndex(parts, [&](int part) { f(begin(part), begin(part + 1)); });
}

}  // namespace slom::detail
