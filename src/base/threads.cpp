#include "slom/base/threads.hpp"

#include "base/threads.hpp"

namespace slom {

void withThreads(int threads, const std::function<void()>& f) {
  detail::ThreadArena arena;
  arena.setThreads(threads);
  arena.run(f);
}

void forEachOnThreads(int count, const std::function<void(int)>& f) { detail::forEachIndex(count, f); }

}  // namespace slom
