// Files packed by bzip2: never more text than the limit.
#include <algorithm>

#include <slom/io/bal.hpp>

#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(bzip2) {
  std::string text;
  if (!accepted([&] { text = slom::io::bzip2Decompressed("FILE", input); })) return;
  require(text.size() <= std::max<std::size_t>(std::size_t{16} << 20, 100 * input.size()),
          "more text than the limit");
}
