#include "support/build_info.hpp"

#include <dlfcn.h>
#include <filesystem>
#include <fstream>

namespace slom::bench {

std::string compilerName() {
#if defined(__clang__)
  return std::string("clang ") + __clang_version__;
#else
  return std::string("g++ ") + __VERSION__;
#endif
}

std::string compileFlags() { return SLOM_BENCH_FLAGS; }

std::string instructionSet() {
  std::string set = "SSE2";
#ifdef __AVX__
  set = "AVX";
#endif
#ifdef __AVX2__
  set = "AVX2";
#endif
#ifdef __AVX512F__
  set = "AVX-512";
#endif
#ifdef __FMA__
  set += " FMA";
#endif
  return set;
}

std::string processorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "";
}

std::string blasLibrary() {
  Dl_info info{};
  void* const dgemm = dlsym(RTLD_DEFAULT, "dgemm_");
  if (dgemm == nullptr || dladdr(dgemm, &info) == 0) return "";
  const std::filesystem::path file = std::filesystem::weakly_canonical(info.dli_fname);
  const std::string folder = file.parent_path().filename().string(), name = file.filename().string();
  return folder.find("linux-gnu") == std::string::npos ? folder + "/" + name : name;
}

}  // namespace slom::bench
