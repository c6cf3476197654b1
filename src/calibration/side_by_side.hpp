/// Side by side: work on each camera or image, on several threads.
#pragma once

#include <cstddef>
#include <exception>
#include <vector>

#include "slom/base/threads.hpp"

namespace slom::calibration {

/// Runs f(i) for i from 0 to count - 1. Then throws the error of the smallest i that has one.
template <class F>
void sideBySide(std::size_t count, const F& f) {
  std::vector<std::exception_ptr> errors(count);
  forEachOnThreads(int(count), [&](int i) {
    try {
      f(std::size_t(i));
    } catch (...) {
      errors[std::size_t(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace slom::calibration
