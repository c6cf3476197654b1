#include "slom/distributed/pieces.hpp"

#include <utility>
#include <vector>

#include "distributed/index.hpp"
#include "slom/io/numbered_lines.hpp"

namespace slom::distributed {

void gatherInOrder(const Processes& processes, std::int64_t count, const ItemTexts& own, const TextSink& f) {
  constexpr std::int64_t window = 1 << 15;  // numbers in a piece
  std::size_t next = 0;
  std::string text;
  for (std::int64_t begin = 0; begin < count; begin += window) {
    io::NumberedLines lines;
    for (; next < own.size && own.number(next) < begin + window; ++next) {
      text.clear();
      own.append(next, text);
      lines.add(text, int(own.number(next) - begin));
    }
    std::vector<std::string> to_each(at(processes.size()), io::NumberedLines().bytes());
    to_each.front() = lines.bytes();
    io::NumberedLines all;
    for (const std::string& bytes : processes.exchange(to_each)) all.addBytes(bytes);
    processes.agree([&] {
      if (processes.rank() > 0) return;
      all.sort();
      std::string piece;
      for (int i = 0; i < all.size(); ++i) piece += all[i];
      f(piece);
    });
  }
}

}  // namespace slom::distributed
