// Sentences of the library about a fit, in words of the command.
#pragma once

#include <string>

#include <slom/optimize/summary.hpp>

namespace slom::app {

/// Replaces functions and options of the library in the sentence by options and lines of files.
std::string inWordsOfTheCommand(std::string sentence);

/// Replaces them in a fit's message and warnings.
void putIntoWordsOfTheCommand(Summary& summary);

}  // namespace slom::app
