/// Checks of code that may come from outside.
#pragma once

#include "slom/tape/tape.hpp"

namespace slom::tape {

/// Throws [slom.bad-tape] unless the code reads only registers that have values, writes only results, and computes all
/// outputs.
void checkCode(const Code& code);

/// Returns how many measurements an instruction works on at once: 64, or 32 if the first-level cache is too small.
int lanesFor(const Code& code);

}  // namespace slom::tape
