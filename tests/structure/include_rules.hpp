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

/// Checks the tree `root`. include/ and src/:
///   * mtk includes mtk, Eigen and the standard library;
///   * include/slom/<step> and src/<step> include mtk and the steps from model down to their own;
///   * files directly in include/slom and src, the facade, include all of these;
///   * include/slom/filter, filters in headers alone, includes mtk and model;
///   * include/slom/measurements, kinds of measurements, includes mtk and model, and is included by the facade alone;
///   * include/slom/calibration and src/calibration, a library of its own, include public headers of all of these and their
///     own files, and may use fmt in src/; nobody of the above includes them;
///   * nobody includes apps/, or what only the command may use: fmt, JSON, CLI11, OpenCV;
///   * io and io.hpp, readers of file formats, include all public headers and their own files of src/io, and may use fmt
///     there; nothing else of the libraries includes them;
///   * public headers include neither <iostream> nor other libraries than Eigen and oneTBB;
/// and apps/slom, the command:
///   * it includes public headers of the library, never src/, and its own files by their path from apps/slom;
///   * a subcommand includes its own files, those beside main.cpp, and fitting/, never another subcommand's;
///   * the folders of a subcommand do not include each other in a circle;
/// and bench/, the benchmarks:
///   * they include their own files and those of tests/ by quotes, and what is installed by brackets; nothing of apps/.
IncludeReport checkIncludes(const std::filesystem::path& root);

}  // namespace slom::testing
