// Input files, read by the library's functions. Their errors carry the text that the command shows.
#pragma once

#include <slom/io/input_file.hpp>

namespace slom::app {

using io::cannotRead;
using io::InputStream;
using io::openInput;
using io::readWhole;

}  // namespace slom::app
