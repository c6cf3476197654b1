// What the library says of a fit, in words of the command.
#pragma once

#include <string>

#include <slom/optimize/summary.hpp>

namespace slom::app {

/// The sentence with options and lines of files in place of functions and options of the library.
std::string inWordsOfTheCommand(std::string sentence);

/// The same of a fit's message and warnings.
void putIntoWordsOfTheCommand(Summary& summary);

}  // namespace slom::app
