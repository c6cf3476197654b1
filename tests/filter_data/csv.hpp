#pragma once
// Rows of the CSV files of the public data sets.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace slom::testing {

/// Returns the rows of a file of numbers without its header line.
inline std::vector<std::vector<double>> readRows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    rows.emplace_back();
    char* at = line.data();
    for (char* end = nullptr; *at != '\0'; at = *end == ',' ? end + 1 : end) {
      rows.back().push_back(std::strtod(at, &end));
      if (end == at) break;
    }
  }
  return rows;
}

}  // namespace slom::testing
