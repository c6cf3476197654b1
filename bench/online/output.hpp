/// What bench_online prints and writes.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "online/replay.hpp"

namespace slom::bench {

/// A file and all that was measured with it.
struct FileResult {
  std::string file;
  int poses = 0, edges = 0;
  std::vector<Replay> replays;  ///< that by update() first
  Memory memory;                ///< all 0: not measured
};

void printHead();
/// A line for each replay.
void print(const FileResult& result);
/// Times in seconds, distances in metres, memory in bytes.
void writeJson(const std::vector<FileResult>& results, std::ostream& os);

}  // namespace slom::bench
