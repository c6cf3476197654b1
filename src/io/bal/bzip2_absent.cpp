// Replacement of bzip2_libbz2.cpp for builds without libbz2.
#include <fmt/format.h>

#include "io/fault.hpp"
#include "slom/io/bal.hpp"

namespace slom::io {

const bool has_bzip2 = false;

std::string bzip2Decompressed(const std::string& file, std::string_view) {
  fail("no-bzip2",
       fmt::format(
           "{}: the file is compressed by bzip2, and this slom was built without libbz2; decompress it "
           "with bunzip2, or install libbz2-dev and build slom again",
           file),
       file);
}

}  // namespace slom::io
