/// Loops on the threads of the arena that they run in. Only this header knows oneTBB. Without oneTBB
/// (SLOM_WITH_TBB=OFF) there is 1 thread, and the results are the same, bitwise.
#pragma once

#include <algorithm>
#include <vector>

#ifdef SLOM_WITH_TBB
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include "mtk/detail/sanitizers.hpp"

#ifdef MTK_THREAD_SANITIZER
#include <atomic>
#include <thread>
#endif

namespace slom::detail {

#ifdef SLOM_WITH_TBB
/// Returns the number of threads of the caller's arena.
inline int threadCount() { return tbb::this_task_arena::max_concurrency(); }

/// An arena: code run in it uses at most its number of threads.
class ThreadArena {
 public:
  /// Sets the number of threads; 0, or more than the machine has: all of the machine.
  void setThreads(int threads) {
    const int most = tbb::info::default_concurrency();
    arena_.terminate();
    arena_.initialize(threads > 0 ? std::min(threads, most) : most);
  }
  template <class F>
  auto run(const F& f) {
    return arena_.execute(f);
  }

 private:
  tbb::task_arena arena_;
};
#else
inline int threadCount() { return 1; }

class ThreadArena {
 public:
  void setThreads(int) {}
  template <class F>
  auto run(const F& f) {
    return f();
  }
};
#endif

#if defined(MTK_THREAD_SANITIZER) && defined(SLOM_WITH_TBB)
/// Runs a loop on plain threads under the thread sanitizer. oneTBB's library is compiled without that sanitizer, which
/// therefore misses some locks and queues and reports false races. With plain threads, it judges the bodies of the
/// loops; these do not throw. The relaxed counter orders no body before another.
template <class F>
void runOnThreads(int count, const F& f) {
  constexpr int threads = 4;
  std::atomic<int> next = 0;
  const auto run = [&] {
    for (int i = next.fetch_add(1, std::memory_order_relaxed); i < count;
         i = next.fetch_add(1, std::memory_order_relaxed)) {
      f(i);
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < std::min(count, threads); ++i) others.emplace_back(run);
  run();
  for (std::thread& other : others) other.join();
}
#elif defined(SLOM_WITH_TBB)
template <class F>
void runOnThreads(int count, const F& f) {
  tbb::parallel_for(0, count, f);
}
#endif

/// Runs f(0) ... f(count - 1), each once.
template <class F>
void forEachIndex(int count, const F& f) {
#ifdef SLOM_WITH_TBB
  if (count > 1 && threadCount() > 1) return runOnThreads(count, f);
#endif
  for (int i = 0; i < count; ++i) f(i);
}

/// Cuts [0, n) into `parts` ranges of about the same work and runs f(first, last) for each. work[i] is the total work
/// of all indices before i; n + 1 entries.
template <class F>
void forEachRange(const std::vector<double>& work, int parts, const F& f) {
  const auto begin = [&](int part) {
    const auto found = std::lower_bound(work.begin(), work.end(), work.back() * part / parts);
    return static_cast<int>((part == parts ? work.end() - 1 : found) - work.begin());
  };
  forEachIndex(parts, [&](int part) { f(begin(part), begin(part + 1)); });
}

}  // namespace slom::detail
