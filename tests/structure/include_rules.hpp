#pragma once
// The include rule of the project: the folders are the steps of the data flow, and a file may include its own
// step and those above, never one below.

#include <filesystem>
#include <string>
#include <vector>

namespace slom::testing {

struct IncludeReport {
  int files = 0;                        ///< read
  std::vector<std::string> violations;  ///< `file:line: includes <name>: <rule>`, sorted
};

/// Checks include/ and src/ of the tree `root`:
///   * mtk includes mtk, Eigen and the standard library;
///   * include/slom/<step> and src/<step> include mtk and the steps from model down to their own;
///   * files directly in include/slom and src, the facade, include all of these;
///   * include/slom/measurements, kinds of measurements, includes mtk and model, and is included by the facade alone;
///   * nobody includes apps/, or what only the command may use: fmt, JSON, CLI11, OpenCV;
///   * public headers include neither <iostream> nor other libraries than Eigen and oneTBB.
IncludeReport checkIncludes(const std::filesystem::path& root);

}  // namespace slom::testing
