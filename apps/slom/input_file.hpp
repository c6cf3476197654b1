// Files that are read, by the library's functions; their errors have the text that the command shows.
#pragma once

#include <slom/io/input_file.hpp>

namespace slom::app {

using io::cannotRead;
using io::InputStream;
using io::openInput;
using io::readWhole;

}  // namespace slom::app
