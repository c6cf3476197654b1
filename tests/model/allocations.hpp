#pragma once
// Counter of memory allocations, which shows the cost of insertion.

#include <cstddef>

namespace slom::testing {

/// Calls of operator new until now. 0 under the sanitizers, which bring an operator new of their own.
std::size_t allocations();

}  // namespace slom::testing
