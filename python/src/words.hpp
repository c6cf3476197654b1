// Messages of the library in the words of the package.
#pragma once

#include <string>
#include <vector>

namespace slom::python {

/// Returns a message with the names of Python in place of those of C++ (slom/_words.py).
std::string inWords(const std::string& message);
std::vector<std::string> inWords(std::vector<std::string> messages);

}  // namespace slom::python
