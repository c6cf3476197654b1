// Files that are read as a whole, and what is said of those that cannot be.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>

namespace slom::app {

/// Throws the UserError of a file that cannot be opened or read; errno says why.
[[noreturn]] void cannotRead(const std::string& file);

struct CloseFile {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using InputStream = std::unique_ptr<std::FILE, CloseFile>;

/// A file, a pipe or a terminal, opened; UserError for what cannot be opened, and for other devices, which
/// may have no end.
InputStream openInput(const std::string& file);

/// Larger files are no input of this program: the largest known bundle adjustment takes 2 GB.
inline constexpr std::size_t largest_input = std::size_t{4} << 30;

/// All bytes of a file or pipe; UserError when it cannot be read or has more than `most` bytes, for a file
/// before any memory is taken.
std::string readWhole(const std::string& file, std::size_t most = largest_input);

}  // namespace slom::app
