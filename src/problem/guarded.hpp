/// Guarded calls of the user's functions.
#pragma once

#include <exception>

#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// Returns f(), which calls the user's functions. Their exceptions become a MeasurementThrew; the library's own errors
/// pass unchanged. `i` is the current measurement at the time of the exception.
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
