// Compiles, but says nothing about the header, which is not the first.
#include "needs_another.hpp"

#include <vector>
