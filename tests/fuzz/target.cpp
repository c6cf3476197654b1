#include "fuzz/target.hpp"

#include <unistd.h>

#include <sys/mman.h>

#include <mtk/error.hpp>

#include "error.hpp"

namespace slom::fuzz {

namespace {

void requireSentence(const std::string& text) {
  require(!text.empty() && text.size() < 4000,
          "the sentence has " + std::to_string(text.size()) + " characters");
  for (const char* internal : {"std::", "basic_string", "vector::", "json.exception", "stoi", "bad_alloc"})
    require(text.find(internal) == std::string::npos, "the sentence speaks of the program: " + text);
}

}  // namespace

bool accepted(const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const app::UserError& error) {
    requireSentence(error.what());
  } catch (const mtk::Error& error) {
    requireSentence(error.what());
  }
  return false;
}

MemoryFile::MemoryFile(std::string_view content) : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
  require(descriptor_ >= 0, "no file in memory");
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor_, content.data(), content.size());
    require(written > 0, "the file in memory is not written");
    content.remove_prefix(std::size_t(written));
  }
  name_ = "/proc/self/fd/" + std::to_string(descriptor_);
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

}  // namespace slom::fuzz
