#pragma once
// Result files that appear complete or not at all.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace slom::app {

/// An option and the file that it names; an empty name stands for no file.
struct NamedFile {
  std::string option;
  std::string file;
};

/// No result may replace an input or another result, and each must be a file: throws UserError, naming the
/// option. A file is the same one under all its names, symbolic and hard links.
void checkResultPaths(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& results);

/// Finds out before the work, not after it, that a file cannot be written; throws UserError.
void requireWritable(const std::vector<std::string>& files);

/// A set of files that is written as one: add() writes each under a temporary name beside its place, commit()
/// gives all of them their names. Whatever is not committed is removed again, so that a failure, also of a
/// later file, leaves what was there before.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// A symbolic link stays one: what it leads to is replaced. Other hard links of that keep
  /// the old content. Throws UserError when the file cannot be
  /// written.
  void add(const std::filesystem::path& name, std::string_view content);
  void commit();

 private:
  struct File {
    std::filesystem::path temporary;
    std::filesystem::path path;
  };
  std::vector<File> files_;
};

}  // namespace slom::app
