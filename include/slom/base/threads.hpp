/// Threads for code that calls solvers itself or has its own loops. An Estimator does not need them.
#pragma once

#include <functional>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Runs f. The library's loops within f use at most this many threads; 0: all of the machine. Results do not depend on
/// the number. Without oneTBB there is 1 thread.
void withThreads(int threads, const std::function<void()>& f);

/// Runs f(0) ... f(count - 1), each once, on the threads of the enclosing withThreads, or else on all of the machine.
/// An exception of f ends the loop and is rethrown here.
void forEachOnThreads(int count, const std::function<void(int)>& f);

}  // namespace slom
