/// Threads for code that calls solvers itself or has loops of its own. An Estimator needs none of it.
#pragma once

#include <functional>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Runs f; the library's loops within it use at most this many threads, 0: as many as the machine has. Results do not depend on
/// the number. Without oneTBB there is one.
void withThreads(int threads, const std::function<void()>& f);

/// Runs f(0) ... f(count - 1), each once, on the threads of the withThreads around it, else on as many as the machine has. What
/// f throws ends the loop and is thrown here.
void forEachOnThreads(int count, const std::function<void(int)>& f);

}  // namespace slom
