/// What the caller of a benchmark can put right.
#pragma once

#include <stdexcept>

namespace slom::bench {

/// The text says which option or file, what is wrong with it, and what to do.
struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace slom::bench
