#include "io/pieces.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include <sys/stat.h>

#include "io/fault.hpp"
#include "slom/io/input_file.hpp"

namespace slom::io {

void forEachPiece(const std::string& file, const std::function<void(const NumberedLines&)>& f) {
  constexpr std::int64_t piece = 4 << 20;  // bytes
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) cannotRead(file);
  const auto pieces = int(std::max<std::int64_t>(1, std::int64_t(status.st_size) / piece));
  int line = 0;
  for (int p = 0; p < pieces; ++p) {
    PartOfFile part = readLinesOfPart(file, p, pieces);
    if (part.line_count > std::numeric_limits<int>::max() - line)
      fail("too-large",
           fmt::format("{}: more than {} lines, the limit; write a container by another program", file,
                       std::numeric_limits<int>::max()),
           file);
    part.lines.shift(line);
    line += part.line_count;
    f(part.lines);
  }
}

}  // namespace slom::io
