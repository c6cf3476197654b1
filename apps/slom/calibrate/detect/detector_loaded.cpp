#include <dlfcn.h>
#include <filesystem>

#include <fmt/format.h>

#include "calibrate/detect/detector_module.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

/// Where the shared object may be, from the folder of the program: built or installed with it, or that of a
/// test.
constexpr const char* places[] = {".", SLOM_LIBRARIES_FROM_COMMAND, "../apps", "../../apps"};

void* loaded() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const char* place : places) {
    const fs::path file = program / place / "libslom_detect.so";
    if (!fs::exists(file, ignored)) continue;
    if (void* const library = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL)) return library;
    throw UserError(fmt::format(
        "--images: {} cannot be loaded ({}); install OpenCV, or give the corners by --camera NAME=FILE",
        file.lexically_normal().string(), ::dlerror()));
  }
  throw UserError(
      fmt::format("--images: there is no libslom_detect.so in {} or {}, which finds boards; install slom as "
                  "a whole, or give "
                  "the corners by --camera NAME=FILE",
                  program.string(), (program / SLOM_LIBRARIES_FROM_COMMAND).lexically_normal().string()));
}

const DetectorModule& module() {
  static const auto* const found =
      static_cast<const DetectorModule*>(::dlsym(loaded(), "slom_detector_module"));
  if (!found) throw UserError("--images: libslom_detect.so is of another slom; install slom as a whole");
  return *found;
}

}  // namespace

std::vector<FoundCorner> findBoard(const Board& board, const Photograph& photo) {
  return module().find_board(board, photo);
}

bool showsChessboard(const Board& board, const Photograph& photo) {
  return module().shows_chessboard(board, photo);
}

void requireDetector(const Board& board) {
  if (const std::string complaint = module().complaint(board); !complaint.empty()) throw UserError(complaint);
}

}  // namespace slom::app::calib
