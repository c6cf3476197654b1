/// Mistakes that the caller of a benchmark can correct.
#pragma once

#include <stdexcept>

namespace slom::bench {

/// The error. Its text says which option or file, what is wrong, and what to do.
struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace slom::bench
