// Compiles, but says nothing about the header, which is not the first.
#include <vector>

#include "needs_another.hpp"
