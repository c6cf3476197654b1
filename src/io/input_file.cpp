#include "slom/io/input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/stat.h>

#include "io/fault.hpp"

namespace slom::io {

namespace {

[[noreturn]] void refuseLarge(const std::string& file, std::size_t most) {
  fail("too-large", fmt::format("{}: larger than {} bytes, the limit; give a smaller file", file, most),
       file);
}

}  // namespace

void cannotRead(const std::string& file) {
  fail("cannot-read", fmt::format("{}: cannot be read ({}); check the path", file, std::strerror(errno)),
       file);
}

InputStream openInput(const std::string& file) {
  InputStream stream(std::fopen(file.c_str(), "rbe"));
  struct stat status {};
  if (!stream || ::fstat(::fileno(stream.get()), &status) != 0) cannotRead(file);
  const bool is_terminal = ::isatty(::fileno(stream.get())) != 0;
  if (S_ISBLK(status.st_mode) || (S_ISCHR(status.st_mode) && !is_terminal)) {
    fail("device", fmt::format("{}: this is a device; give a file or a pipe", file), file);
  }
  return stream;
}

std::string readWhole(const std::string& file, std::size_t most) {
  const InputStream stream = openInput(file);
  struct stat status {};
  if (::fstat(::fileno(stream.get()), &status) != 0) cannotRead(file);
  const auto announced = std::size_t(status.st_size);  // 0 for pipes
  if (S_ISREG(status.st_mode) && announced > most) refuseLarge(file, most);
  const std::size_t first = S_ISREG(status.st_mode) ? announced : 0;
  std::string text(std::max(first + 1, std::size_t{1} << 16), '\0');
  for (std::size_t size = 0;;) {
    size += std::fread(text.data() + size, 1, text.size() - size, stream.get());
    if (std::ferror(stream.get()) != 0) cannotRead(file);
    if (size > most) refuseLarge(file, most);
    if (size < text.size()) {
      text.resize(size);
      return text;
    }
    text.resize(std::min(2 * size, most + 1));
  }
}

}  // namespace slom::io
