// Files that are read as a whole, and what is said of those that cannot be.
#pragma once

#include <string>

namespace slom::app {

/// Throws the UserError of a file that cannot be opened or read; errno says why.
[[noreturn]] void cannotRead(const std::string& file);

/// All bytes of a file or pipe; UserError when it cannot be read.
std::string readWhole(const std::string& file);

}  // namespace slom::app
