#include "input_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app {

void cannotRead(const std::string& file) {
  throw UserError(fmt::format("{}: cannot be read ({}); check the path", file, std::strerror(errno)));
}

std::string readWhole(const std::string& file) {
  const auto close = [](std::FILE* stream) { std::fclose(stream); };
  const std::unique_ptr<std::FILE, decltype(close)> stream(std::fopen(file.c_str(), "rb"), close);
  if (!stream) cannotRead(file);
  std::string text(std::size_t{1} << 16, '\0');
  for (std::size_t size = 0;;) {
    size += std::fread(text.data() + size, 1, text.size() - size, stream.get());
    if (std::ferror(stream.get()) != 0) cannotRead(file);
    if (size < text.size()) {
      text.resize(size);
      return text;
    }
    text.resize(2 * size);
  }
}

}  // namespace slom::app
