// Fuzz targets: functions of arbitrary bytes. The program `fuzzer` finds inputs for one of them. An ordinary test runs
// all of them on the cases of the repository.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace slom::fuzz {

struct Target {
  const char* name;  ///< name of its folder in tests/fuzz/cases
  void (*run)(std::string_view input);
};

/// All that are linked.
inline std::vector<Target>& targets() {
  static std::vector<Target> all;
  return all;
}

/// Requires a property that holds for every input. The exception ends a fuzzer, which stores the input.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

/// Reads; an input that is wrong is refused with a sentence, by a UserError or an error of the library, and
/// by nothing else. Returns whether it was accepted.
bool accepted(const std::function<void()>& read);

/// A file with this content, of a name that is the same for all of them. It lies in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content);
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile();
  const std::string& name() const { return name_; }

 private:
  int descriptor_;
  std::string name_;
};

}  // namespace slom::fuzz

/// SLOM_FUZZ_TARGET(graph) { ... input ... }
#define SLOM_FUZZ_TARGET(name)                                                            \
  namespace slom::fuzz {                                                                  \
  static void name##Target(std::string_view input);                                       \
  static const bool name##_is_known = (targets().push_back({#name, name##Target}), true); \
  }                                                                                       \
  void slom::fuzz::name##Target([[maybe_unused]] std::string_view input)
