// Compiles, but says nothing about the header, which is not the first.
// clang-format off
#include <vector>

#include "needs_another.hpp"
