/// Output of bench_online.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "online/replay.hpp"

namespace slom::bench {

/// A file and all its measured results.
struct FileResult {
  std::string file;
  int poses = 0, edges = 0;
  std::vector<Replay> replays;  ///< the replay by update() comes first
  Memory memory;                ///< all 0: not measured
};

void printHead();
/// Prints a line for each replay.
void print(const FileResult& result);
/// Writes times in seconds, distances in metres and memory in bytes.
void writeJson(const std::vector<FileResult>& results, std::ostream& os);

}  // namespace slom::bench
