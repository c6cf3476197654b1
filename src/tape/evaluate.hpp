/// Choice of kernels for the evaluation of tapes, for tests and benchmarks.
#pragma once

#include "tape/kernels.hpp"

namespace slom::tape {

/// Evaluates all tapes from now on with these kernels. Not to be called while a tape is evaluated.
void evaluateBy(const Kernels& with);

}  // namespace slom::tape
