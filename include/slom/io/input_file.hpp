/// Reading of files, pipes and terminals, and errors for those that cannot be read.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>

#include "mtk/detail/cpp20.hpp"

namespace slom::io {

/// Throws [slom.io.cannot-read] for a file that cannot be opened or read. errno must hold the reason.
[[noreturn]] void cannotRead(const std::string& file);

/// Closes a C stream at the end of its owner.
struct CloseFile {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using InputStream = std::unique_ptr<std::FILE, CloseFile>;

/// Opens a file, a pipe or a terminal. Throws [slom.io.cannot-read] if it cannot be opened, and [slom.io.device] for
/// other devices, which may have no end.
InputStream openInput(const std::string& file);

/// Largest file size that is read. The largest known bundle adjustment takes 2 GB.
inline constexpr std::size_t largest_input = std::size_t{4} << 30;

/// Returns all bytes of a file or pipe. Throws as openInput does, and [slom.io.too-large] for more than `most` bytes.
/// For a file this is checked before memory is allocated.
std::string readWhole(const std::string& file, std::size_t most = largest_input);

}  // namespace slom::io
