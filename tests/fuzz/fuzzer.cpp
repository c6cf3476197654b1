// The program of libFuzzer:
//
//   fuzzer --target=graph [options of libFuzzer] [folders of cases]
#include <cstdio>
#include <cstdlib>

#include "fuzz/target.hpp"

namespace {

const slom::fuzz::Target* chosen = nullptr;

const slom::fuzz::Target* find(std::string_view name) {
  for (const auto& target : slom::fuzz::targets()) {
    if (target.name == name) return &target;
  }
  return nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
  constexpr std::string_view option = "--target=";  // words with two dashes are none of libFuzzer's
  for (int i = 1; i < *count; ++i) {
    const std::string_view word = (*words)[i];
    if (word.starts_with(option)) chosen = find(word.substr(option.size()));
  }
  if (chosen == nullptr) {
    std::fputs("fuzzer: say which, by --target=NAME; there are:", stderr);
    for (const auto& target : slom::fuzz::targets()) std::fprintf(stderr, " %s", target.name);
    std::fputs("\n", stderr);
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  chosen->run(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
