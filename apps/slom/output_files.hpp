#pragma once
// Result files that appear complete or not at all.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace slom::app {

/// An option and the file that it names; empty name: no file.
struct NamedFile {
  std::string option;
  std::string file;
};

/// Checks that no result replaces an input or another result, and that each result is a file. Otherwise throws
/// UserError that names the option. A file is the same under all its names, symbolic and hard links.
void checkResultPaths(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& results);

/// Checks before the work that the files can be written. Throws UserError.
void requireWritable(const std::vector<std::string>& files);

/// A set of files that is written as one. add() or open() writes each file under a temporary name beside its place; commit()
/// gives all files their names. Files that are not committed are removed. So a failure, even in a later file, leaves
/// the previous files unchanged.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// Adds a file. A symbolic link stays: its target is replaced. Other hard links of the target keep the old content.
  /// Throws UserError if the file cannot be written.
  void add(const std::filesystem::path& name, std::string_view content);
  /// Begins a file that is written in pieces: append() adds to it, close() ends it. Throws as add() does.
  void open(const std::filesystem::path& name);
  void append(std::string_view piece);
  void close();
  /// Returns the open file, to write at offsets.
  int descriptor() const { return descriptor_; }
  void commit();

 private:
  struct File {
    std::filesystem::path temporary;
    std::filesystem::path path;
    std::filesystem::path name;  // as given, for messages
  };
  std::vector<File> files_;
  int descriptor_ = -1;  // of the last file, while it is open
};

}  // namespace slom::app
