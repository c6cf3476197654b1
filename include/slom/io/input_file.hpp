/// Files, pipes and terminals that are read, and what is said of those that cannot be.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>

#include "mtk/detail/cpp20.hpp"

namespace slom::io {

/// Throws [slom.io.cannot-read], for a file that cannot be opened or read; errno says why.
[[noreturn]] void cannotRead(const std::string& file);

/// Closes a stream of C when its owner goes.
struct CloseFile {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using InputStream = std::unique_ptr<std::FILE, CloseFile>;

/// A file, a pipe or a terminal, opened. Throws [slom.io.cannot-read] for what cannot be opened, and [slom.io.device] for other
/// devices, which may have no end.
InputStream openInput(const std::string& file);

/// Larger files are not read: the largest known bundle adjustment takes 2 GB.
inline constexpr std::size_t largest_input = std::size_t{4} << 30;

/// All bytes of a file or pipe. Throws what openInput throws, and [slom.io.too-large] where there are more than `most` bytes, for
/// a file before any memory is taken.
std::string readWhole(const std::string& file, std::size_t most = largest_input);

}  // namespace slom::io
