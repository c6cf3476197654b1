#include "fuzz/target.hpp"

#include <unistd.h>

#include <sys/mman.h>

#include <mtk/error.hpp>

#include "error.hpp"

namespace slom::fuzz {

bool accepted(const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const app::UserError& error) {
    require(*error.what() != 0, "refused without a word");
  } catch (const mtk::Error& error) {
    require(*error.what() != 0, "refused without a word");
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
