#include "output_files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app {

namespace {

[[noreturn]] void cannotWrite(const std::filesystem::path& path, const std::string& reason) {
  throw UserError(fmt::format("cannot write {}: {}; name a file in a folder that exists and may be written",
                              path.string(), reason));
}

/// Results replace whole files: a device or a pipe cannot be one.
void requireFile(const NamedFile& result) {
  std::error_code ignored;
  const auto status = std::filesystem::status(result.file, ignored);
  const bool is_file = !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
  if (is_file && !result.file.starts_with("/dev/"))
    return;  // /dev/stdout may lead to a file, and is a link to keep
  throw UserError(fmt::format("{} {}: this is {}; give the name of a file", result.option, result.file,
                              std::filesystem::is_directory(status) ? "a folder" : "a device or a pipe"));
}

/// Where a symbolic link leads, so that the file is replaced and not the link.
std::filesystem::path target(const std::filesystem::path& path) {
  return std::filesystem::is_symlink(path) ? std::filesystem::weakly_canonical(path) : path;
}

}  // namespace

void checkResultPaths(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& results) {
  std::map<std::filesystem::path, std::string> uses;
  std::error_code ignored;
  for (const NamedFile& input : inputs) {
    if (!input.file.empty())
      uses.emplace(std::filesystem::weakly_canonical(input.file, ignored), input.option);
  }
  for (const NamedFile& result : results) {
    if (result.file.empty()) continue;
    const auto [known, is_new] =
        uses.emplace(std::filesystem::weakly_canonical(result.file, ignored), result.option);
    if (!is_new) {
      throw UserError(fmt::format("{} {}: this is the file of {} too; give another one", result.option,
                                  result.file, known->second));
    }
  }
  for (const NamedFile& result : results) {
    if (!result.file.empty()) requireFile(result);
  }
}

void requireWritable(const std::vector<std::string>& files) {
  OutputFiles probe;  // removes what it wrote when it goes
  for (const std::string& file : files) {
    if (!file.empty()) probe.add(file, "");
  }
}

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const File& file : files_) std::filesystem::remove(file.temporary, ignored);
}

void OutputFiles::add(const std::filesystem::path& name, std::string_view content) {
  const std::filesystem::path path = target(name);
  if (std::filesystem::is_directory(path)) cannotWrite(path, "it is a folder");
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.partial", ::getpid());
  files_.push_back({temporary, path});

  errno = 0;
  std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) cannotWrite(path, errno != 0 ? std::strerror(errno) : "the disk took only a part");
}

void OutputFiles::commit() {
  for (const File& file : files_) {
    std::error_code error;
    std::filesystem::rename(file.temporary, file.path, error);
    if (error) cannotWrite(file.path, error.message());
  }
  files_.clear();
}

}  // namespace slom::app
