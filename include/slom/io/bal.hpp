/// Bundle adjustments from and to files of BAL, "Bundle adjustment in the large". docs/bundle.md describes the format.
#pragma once

#include <string>
#include <string_view>

#include "slom/io/scene.hpp"

namespace slom::io {

/// Reads a file or pipe, plain or compressed by bzip2. Throws the errors of readWhole and [slom.io.empty-file]. Throws
/// [slom.io.bad-line] with file and line for a word that does not follow the format. For compressed files throws
/// [slom.io.damaged], and [slom.io.no-bzip2] if this library was built without libbz2. Points without observations and
/// points behind cameras are not errors here.
Scene readScene(const std::string& file);

/// Reads a scene from the content of a plain file; `file` is for messages.
Scene parseScene(const std::string& file, std::string_view text);

/// Returns the text of a BAL file: numbers with all digits, rotation vectors of a length up to pi.
std::string toBal(const Scene& scene);

/// Returns the content before compression by bzip2. Throws [slom.io.damaged] and [slom.io.no-bzip2], which name `file`.
std::string bzip2Decompressed(const std::string& file, std::string_view content);

/// True if this library was built with libbz2.
extern const bool has_bzip2;

}  // namespace slom::io
