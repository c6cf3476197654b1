/// Calls of the user's functions.
#pragma once

#include <exception>

#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// Returns f(), which calls the user's functions; what they throw becomes a MeasurementThrew, except the library's own errors. `i` is the
/// measurement at work when they throw.
template <class F>
int guarded(const int& i, const F& f) {
  try {
    return f();
  } catch (const Error&) {
    throw;
  } catch (...) {
    throw MeasurementThrew{i, std::current_exception()};
  }
}

}  // namespace slom
