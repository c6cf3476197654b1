#include "slom/io/checkpoint.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <fmt/format.h>

#include "mtk/error.hpp"
#include "slom/io/word_hash.hpp"

namespace slom::io {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void failCheckpoint(const std::string& where, const std::string& what) {
  throw mtk::Error("slom.checkpoint", where + ": " + what, where);
}

[[noreturn]] void cannotWriteCheckpoint(const std::string& name, const std::string& reason) {
  failCheckpoint(
      name, fmt::format(
                "cannot be written ({}); give a folder that exists or can be made, on a disk with space, in "
                "which you may write",
                reason));
}

/// Writes a file under another name, brings it to the disk and gives it its name.
void writeAtOnce(const std::string& name, std::string_view content) {
  const std::string temporary = name + ".new";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) cannotWriteCheckpoint(temporary, std::strerror(errno));
  bool is_good = true;
  while (is_good && !content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    is_good = written > 0;
    if (is_good) content.remove_prefix(std::size_t(written));
  }
  is_good = is_good && ::fsync(file) == 0;
  const int reason = errno;
  ::close(file);
  if (!is_good) cannotWriteCheckpoint(temporary, std::strerror(reason));
  std::error_code error;
  fs::rename(temporary, name, error);
  if (error) cannotWriteCheckpoint(name, error.message());
}

void makeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) cannotWriteCheckpoint(folder, error.message());
}

/// Adds bytes to a hash, word by word; the last word is filled up with 0.
void addTo(WordHash& hash, std::string_view bytes) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), sizeof(std::uint64_t)))) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), std::min(bytes.size(), sizeof word));
    hash.add(word);
  }
}

/// Size and checksum of the values, with which their file begins.
struct Head {
  std::uint64_t size = 0, checksum = 0;
};

/// Returns whether the next bytes of the file have this checksum and are its last ones.
bool isIntact(std::ifstream& file, const Head& head) {
  WordHash hash;
  std::string bytes;
  for (std::uint64_t rest = head.size; rest > 0; rest -= bytes.size()) {
    constexpr std::uint64_t most = 1 << 20;
    bytes.resize(std::min(rest, most));
    if (!file.read(bytes.data(), std::streamsize(bytes.size()))) return false;
    addTo(hash, bytes);
  }
  return hash.value() == head.checksum && file.peek() == std::ifstream::traits_type::eof();
}

/// Calls f(name, bytes) for the values of a file, if all are as they were written.
void readValues(const std::string& name,
                const std::function<void(std::uint64_t name, std::string_view bytes)>& f) {
  constexpr std::uint64_t most_of_a_value = 1 << 20;
  std::ifstream file(name, std::ios::binary);
  Head begin;
  bool is_whole = file.read(reinterpret_cast<char*>(&begin), sizeof begin) && isIntact(file, begin);
  file.clear();
  file.seekg(sizeof begin);
  std::uint64_t rest = begin.size, head[2];
  std::string bytes;
  while (is_whole && rest > 0) {
    is_whole = rest >= sizeof head && file.read(reinterpret_cast<char*>(head), sizeof head) &&
               head[1] <= std::min(rest - sizeof head, most_of_a_value);
    if (!is_whole) break;
    bytes.resize(head[1]);
    is_whole = bool(file.read(bytes.data(), std::streamsize(bytes.size())));
    rest -= sizeof head + head[1];
    if (is_whole) f(head[0], bytes);
  }
  if (!is_whole) failCheckpoint(name, "damaged or missing; begin again without it");
}

}  // namespace

/// The set that the file `checkpoint` names.
struct Checkpoint::Set {
  int number = -1, processes = 0;
  std::string problem;

  static Set of(const std::string& folder) {
    Set set;
    std::ifstream file(folder + "/checkpoint");
    std::string kind;
    if (file >> kind >> set.number >> set.processes && kind == "slom-checkpoint-3") {
      file.get();
      std::getline(file, set.problem);
    } else {
      set.number = -1;
    }
    return set;
  }
};

void Checkpoint::Values::addBytes(std::uint64_t name, const char* value, std::size_t size) {
  const std::uint64_t count = size;
  bytes_.append(reinterpret_cast<const char*>(&name), sizeof name);
  bytes_.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes_.append(value, size);
}

std::string Checkpoint::nameOf(int set, int process, int processes) const {
  return folder_ + "/values-" + std::to_string(set) + "-" + std::to_string(process) + "-of-" +
         std::to_string(processes);
}

const std::string& Checkpoint::problemText() const {
  if (problem_text_.empty()) {
    std::uint64_t hash = 0;
    for (const std::string& text : processes_.gather(std::to_string(problem_.data_hash())))
      hash += std::stoull(text);
    problem_text_ = fmt::format("{}, data {:016x}", problem_.text, hash);
  }
  return problem_text_;
}

void Checkpoint::requireWritable() const {
  processes_.agree([&] {
    if (process_ == 0) makeFolder(folder_);
  });
  processes_.agree([&] {
    const std::string probe = fmt::format("{}/probe-{}", folder_, process_);
    writeAtOnce(probe, "");
    std::error_code ignored;
    fs::remove(probe, ignored);
  });
}

void Checkpoint::write(const Values& own) {
  Set before;
  processes_.agree([&] {
    if (process_ > 0) return;
    makeFolder(folder_);
    before = Set::of(folder_);
  });
  if (written_ < 0) written_ = int(processes_.max(before.number));
  const int set = written_ + 1;
  processes_.agree([&] {
    WordHash hash;
    addTo(hash, own.bytes());
    const Head head{own.bytes().size(), hash.value()};
    std::string content(reinterpret_cast<const char*>(&head), sizeof head);
    writeAtOnce(nameOf(set, process_, count_), content += own.bytes());
  });
  const std::string& problem = problemText();
  processes_.agree([&] {
    if (process_ > 0) return;
    writeAtOnce(folder_ + "/checkpoint", "slom-checkpoint-3 " + std::to_string(set) + " " +
                                             std::to_string(count_) + "\n" + problem + "\n");
    std::error_code ignored;
    for (int p = 0; p < before.processes; ++p)
      fs::remove(nameOf(before.number, p, before.processes), ignored);
  });
  written_ = set;
}

void Checkpoint::read(const std::function<void(std::uint64_t name, std::string_view bytes)>& f) const {
  const std::string& problem = problemText();
  processes_.agree([&] {
    const Set set = Set::of(folder_);
    if (set.number < 0)
      failCheckpoint(folder_, "no checkpoint is there; give the folder of --checkpoint of an earlier run");
    if (set.problem != problem)
      failCheckpoint(folder_, "the checkpoint is of another problem (" + set.problem + " instead of " +
                                  problem + "); give the folder of a run on the same file");
    for (int p = 0; p < set.processes; ++p) readValues(nameOf(set.number, p, set.processes), f);
  });
}

}  // namespace slom::io
