/// Bundle adjustments from and to files of BAL, "Bundle adjustment in the large". docs/bundle.md describes the format.
#pragma once

#include <string>
#include <string_view>

#include "slom/io/scene.hpp"

namespace slom::io {

/// Reads a file or pipe, plain or compressed by bzip2. Throws the errors of readWhole; [slom.io.empty-file]; [slom.io.bad-line],
/// naming file and line, for a word that is not as the format asks; and, of compressed files, [slom.io.damaged] and, where this
/// library was built without libbz2, [slom.io.no-bzip2]. Points without observations and points behind cameras are not errors here.
Scene readScene(const std::string& file);

/// The same from the content of a plain file; `file` is for messages.
Scene parseScene(const std::string& file, std::string_view text);

/// The text of a file of BAL: numbers with all digits; rotation vectors of a length up to pi.
std::string toBal(const Scene& scene);

/// What `content` was before bzip2 compressed it. Throws [slom.io.damaged] and [slom.io.no-bzip2], which name `file`.
std::string bzip2Decompressed(const std::string& file, std::string_view content);

/// Whether this library was built with libbz2.
extern const bool has_bzip2;

}  // namespace slom::io
