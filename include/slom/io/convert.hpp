/// Text files as containers (slom/io/container.hpp) and back, in constant memory.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "slom/io/container.hpp"
#include "slom/io/pose_graph.hpp"

namespace slom::io {

/// Returns what a text file has: a bundle adjustment if its first word is a number, otherwise a pose graph. Throws the
/// errors of openInput, [slom.io.no-parts] for a pipe, and [slom.io.empty-file].
ContainerContent contentOfText(const std::string& file);

/// Writes a file of g2o, TORO or BAL as a container to an open file. `name`: of the container, for messages. Returns the
/// lines that were skipped. Every number keeps its bits. Throws what reading the text throws, and [slom.io.cannot-write].
UnknownTags writeContainer(const std::string& text_file, int descriptor, const std::string& name);

/// Calls f with the text of a container, piece by piece: lines as in the text file, numbers with all digits. Throws the
/// errors of Container.
void readAsText(const Container& container, const std::function<void(std::string_view)>& f);

}  // namespace slom::io
