#include <algorithm>
#include <dlfcn.h>
#include <filesystem>

#include <fmt/format.h>

#include "calibrate/detect/detector_module.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

void* loaded() {
  std::error_code ignored;
  const std::filesystem::path file = detectorFile(std::filesystem::read_symlink("/proc/self/exe", ignored));
  if (!std::filesystem::exists(file, ignored)) {
    throw UserError(
        fmt::format("--images: there is no {}, which finds boards; install slom as a whole, or give the "
                    "corners by --camera "
                    "NAME=FILE",
                    file.string()));
  }
  if (void* const library = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL)) return library;
  throw UserError(fmt::format(
      "--images: {} cannot be loaded ({}); install OpenCV, or give the corners by --camera NAME=FILE",
      file.string(), ::dlerror()));
}

const DetectorModule& module() {
  static const auto* const found =
      static_cast<const DetectorModule*>(::dlsym(loaded(), "slom_detector_module"));
  if (!found) throw UserError("--images: libslom_detect.so is of another slom; install slom as a whole");
  return *found;
}

}  // namespace

std::filesystem::path detectorFile(const std::filesystem::path& program) {
  constexpr const char* name = "libslom_detect.so";
  if (!program.is_absolute()) {
    throw UserError(
        "--images: the system does not say where this program is installed, and so not where "
        "libslom_detect.so is, which finds "
        "boards; mount /proc, or give the corners by --camera NAME=FILE");
  }
  const std::filesystem::path built = SLOM_BUILT_DETECTOR_FOLDER, tree = SLOM_BUILD_TREE;
  const auto [end, unused] = std::mismatch(tree.begin(), tree.end(), program.begin(), program.end());
  if (end == tree.end()) return built / name;
  return (program.parent_path() / SLOM_LIBRARIES_FROM_COMMAND / name).lexically_normal();
}

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
