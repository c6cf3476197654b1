/// Texts that the first process gets in pieces, for files that are too large for its memory.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// Calls f in process 0 with pieces of a text.
using TextSink = std::function<void(std::string_view)>;

/// Items of this process. Together with the items of the other processes, they make a list.
struct ItemTexts {
  std::size_t size = 0;                               ///< number of items of this process
  std::function<std::int64_t(std::size_t i)> number;  ///< place of item i in the list, from 0, ascending in i
  std::function<void(std::size_t i, std::string& text)> append;  ///< appends the text of item i
};

/// Passes the texts of the items of all processes to f, in the order of their numbers 0 to count - 1; items with the
/// same number in the order of the processes. A piece is a few megabytes. All processes must call it. If f throws, all
/// processes throw.
void gatherInOrder(const Processes& processes, std::int64_t count, const ItemTexts& own, const TextSink& f);

}  // namespace slom::distributed
