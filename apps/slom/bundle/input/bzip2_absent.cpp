// In place of bzip2_libbz2.cpp where libbz2 was not found.
#include <fmt/format.h>

#include "bundle/input/bzip2.hpp"
#include "error.hpp"

namespace slom::app::bundle {

const bool has_bzip2 = false;

std::string bzip2Decompressed(const std::string& file, std::string_view) {
  throw UserError(fmt::format(
      "{}: the file is compressed by bzip2, and this slom was built without libbz2; decompress it "
      "with bunzip2, or install libbz2-dev and build slom again",
      file));
}

}  // namespace slom::app::bundle
