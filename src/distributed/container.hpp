// Containers of which each process reads a part.
#pragma once

#include <string>

#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// Reads the container once, each process a part of each section, and compares the checksums. Throws [slom.io.damaged]
/// in all.
void requireWhole(const Processes& processes, const std::string& file);

}  // namespace slom::distributed
