#include "output_files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
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

}  // namespace

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const File& file : files_) std::filesystem::remove(file.temporary, ignored);
}

void OutputFiles::add(const std::filesystem::path& path, std::string_view content) {
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
