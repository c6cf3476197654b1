#pragma once
// Result files that appear complete or not at all.

#include <filesystem>
#include <string_view>
#include <vector>

namespace slom::app {

/// A set of files that is written as one: add() writes each under a temporary name beside its place, commit()
/// gives all of them their names. Whatever is not committed is removed again, so that a failure, also of a
/// later file, leaves what was there before.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// Throws UserError when the file cannot be written.
  void add(const std::filesystem::path& path, std::string_view content);
  void commit();

 private:
  struct File {
    std::filesystem::path temporary;
    std::filesystem::path path;
  };
  std::vector<File> files_;
};

}  // namespace slom::app
