// A scene from a BAL file.
#pragma once

#include <string>
#include <string_view>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// Reads a file, plain or compressed by bzip2. Throws UserError, with file and line, for whatever is wrong
/// with its words; what they mean is `checkScene`'s affair.
Scene readScene(const std::string& file);

/// The same from the content of a plain file; `file` is for messages.
Scene parseScene(const std::string& file, std::string_view text);

}  // namespace slom::app::bundle
