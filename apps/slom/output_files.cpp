#include "output_files.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>

#include "error.hpp"
#include "unfinished_files.hpp"

namespace slom::app {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannotWrite(const fs::path& path, const std::string& reason) {
  throw UserError(fmt::format("cannot write {}: {}; name a file in a folder that exists and may be written",
                              path.string(), reason));
}

/// Returns the absolute path of the file itself, with all symbolic links followed. The last link may lead to a file
/// that does not exist yet. Two spellings of one file give one path.
fs::path resolved(const fs::path& path) {
  constexpr int most_links = 40;
  std::error_code ignored;
  fs::path file = fs::absolute(path, ignored);
  for (int i = 0; i < most_links && fs::is_symlink(fs::symlink_status(file, ignored)); ++i) {
    const fs::path target = fs::read_symlink(file, ignored);
    if (ignored) break;
    file = file.parent_path() / target;  // `target` alone if it is absolute
  }
  const fs::path whole = fs::weakly_canonical(file, ignored);
  return ignored ? file.lexically_normal() : whole;
}

/// Returns the same text for all names of a file: device and inode, which hard links share. Returns the path if no file
/// exists yet.
std::string identityOf(const fs::path& path) {
  const fs::path file = resolved(path);
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return file.string();
  return fmt::format("{}:{}", status.st_dev, status.st_ino);
}

bool isBelow(const fs::path& path, const char* folder) {
  return path.lexically_normal().string().starts_with(folder);
}

/// Throws unless the result can replace a whole file: a device or a pipe cannot.
void requireFile(const NamedFile& result) {
  std::error_code ignored;
  const auto status = fs::status(result.file, ignored);
  const bool is_file = !fs::exists(status) || fs::is_regular_file(status);
  const fs::path path = fs::absolute(result.file, ignored);
  if (is_file && !isBelow(path, "/dev/") && !isBelow(path, "/proc/"))
    return;  // /dev/stdout may lead to a file, but the link must stay
  throw UserError(fmt::format("{} {}: this is {}; give the name of a file", result.option, result.file,
                              fs::is_directory(status) ? "a folder" : "a device or a pipe"));
}

/// Returns 16 unpredictable letters and digits.
std::string randomName() {
  constexpr char digits[] = "abcdefghijklmnopqrstuvwxyz012345";
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    throw UserError("no random numbers are available for names of files; try again");
  std::string name;
  for (const unsigned char byte : bytes) name += digits[byte % 32];
  return name;
}

/// Returns the mode of a new file under the umask.
mode_t newFileMode() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

bool writeAll(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(std::size_t(written));
  }
  return true;
}

/// Copies owner, group and permissions from the replaced file, as far as this user may set them.
void keepMode(int descriptor, const fs::path& replaced) {
  struct stat old {};
  if (::stat(replaced.c_str(), &old) != 0) {
    ::fchmod(descriptor, newFileMode());
    return;
  }
  if (old.st_uid != ::geteuid() || old.st_gid != ::getegid()) {
    if (::fchown(descriptor, old.st_uid, old.st_gid) != 0) old.st_mode &= 0777;  // no rights of another owner
  }
  ::fchmod(descriptor, old.st_mode & 07777);
}

}  // namespace

void checkResultPaths(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& results) {
  std::map<std::string, std::string> uses;  // by identity
  for (const NamedFile& input : inputs) {
    if (!input.file.empty()) uses.emplace(identityOf(input.file), input.option);
  }
  for (const NamedFile& result : results) {
    if (result.file.empty()) continue;
    const auto [known, is_new] = uses.emplace(identityOf(result.file), result.option);
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
  OutputFiles probe;  // its destructor removes what it wrote
  for (const std::string& file : files) {
    if (!file.empty()) probe.add(file, "");
  }
}

OutputFiles::~OutputFiles() {
  if (descriptor_ >= 0) ::close(descriptor_);
  for (const File& file : files_) removeUnfinished(file.temporary);
}

void OutputFiles::add(const fs::path& name, std::string_view content) {
  open(name);
  append(content);
  close();
}

void OutputFiles::open(const fs::path& name) {
  const fs::path path = resolved(name);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) cannotWrite(name, "it is a folder");
  // The temporary name has a fixed length, because the file's name may have the maximum length. O_EXCL refuses to
  // follow a link that somebody may have put there.
  const fs::path temporary = path.parent_path() / (".slom-" + randomName());
  expectUnfinished(temporary);
  files_.push_back({temporary, path, name});
  descriptor_ = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (descriptor_ < 0) cannotWrite(name, std::strerror(errno));
  // A name that is too long is refused now, not after the work.
  struct stat unused {};
  if (::lstat(path.c_str(), &unused) != 0 && errno != ENOENT) cannotWrite(name, std::strerror(errno));
}

void OutputFiles::append(std::string_view piece) {
  if (!writeAll(descriptor_, piece)) cannotWrite(files_.back().name, std::strerror(errno));
}

void OutputFiles::close() {
  keepMode(descriptor_, files_.back().path);
  if (::close(std::exchange(descriptor_, -1)) != 0) cannotWrite(files_.back().name, std::strerror(errno));
}

void OutputFiles::commit() {
  for (const File& file : files_) {
    std::error_code error;
    fs::rename(file.temporary, file.path, error);
    if (error) cannotWrite(file.path, error.message());
  }
  for (const File& file : files_) forgetUnfinished(file.temporary);
  files_.clear();
}

}  // namespace slom::app
