/// Bundle adjustments from and to files of BAL, "Bundle adjustment in the large". docs/bundle_files.md describes the format.
#pragma once

#include <string>
#include <string_view>

#include "slom/io/scene.hpp"

namespace slom::io {

/// Reads a file or pipe, plain or compressed by bzip2, or a container. Throws the errors of readWhole and [slom.io.empty-file]. Throws
/// [slom.io.bad-line] with file and line for a word that does not follow the format. For compressed files throws
/// [slom.io.damaged], and [slom.io.no-bzip2] if this library was built without libbz2. Points without observations and
/// points behind cameras are not errors here.
Scene readScene(const std::string& file);

/// Reads a scene from the content of a plain file; `file` is for messages.
Scene parseScene(const std::string& file, std::string_view text);

/// Returns the text of a BAL file: numbers with all digits, rotation vectors of a length up to pi.
std::string toBal(const Scene& scene);

/// Appends the first line of a BAL file. All observations, cameras and points follow, in this order. These functions
/// write a file that is too large for the memory.
void appendBalCounts(std::string& text, std::size_t cameras, std::size_t points, std::size_t observations);
/// Appends the line of an observation.
void appendBal(std::string& text, const Observation& observation);
/// Appends the nine lines of a camera.
void appendBal(std::string& text, const Camera& camera);
/// Appends the three lines of a point.
void appendBal(std::string& text, const mtk::vect<3>& point);
/// Appends a number and the end of its line.
void appendBal(std::string& text, double number);

/// Returns the content before compression by bzip2. Throws [slom.io.damaged] and [slom.io.no-bzip2], which name `file`.
std::string bzip2Decompressed(const std::string& file, std::string_view content);

/// True if this library was built with libbz2.
extern const bool has_bzip2;

}  // namespace slom::io
