#include <algorithm>
#include <dlfcn.h>
#include <filesystem>

#include <fmt/format.h>
#include <sys/stat.h>

#include "calibrate/detect/detector_module.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

void* loaded() {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path file = detectorFile(program);
  if (!std::filesystem::exists(file, ignored)) {
    throw UserError(
        fmt::format("--images: {}, which finds boards, is missing; install slom as a whole, or give the "
                    "corners by --camera NAME=FILE",
                    file.string()));
  }
  requireTrusted(file, program);
  if (void* const library = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL)) return library;
  throw UserError(fmt::format(
      "--images: {} cannot be loaded ({}); install OpenCV, or give the corners by --camera NAME=FILE",
      file.string(), ::dlerror()));
}

const DetectorModule& module() {
  static const auto* const found =
      static_cast<const DetectorModule*>(::dlsym(loaded(), "slom_detector_module"));
  if (!found)
    throw UserError(
        "--images: libslom_detect.so belongs to another slom; install slom as a "
        "whole");
  return *found;
}

/// Returns whether the folder ends with the folder of installed programs, or equals that folder if it is absolute.
bool isInstalled(const std::filesystem::path& folder) {
  const std::filesystem::path installed = SLOM_COMMAND_FOLDER;
  if (installed.is_absolute()) return folder == installed;
  auto part = folder.end();
  for (auto wanted = installed.end(); wanted != installed.begin();) {
    if (part == folder.begin() || *--part != *--wanted) return false;
  }
  return true;
}

}  // namespace

void requireTrusted(const std::filesystem::path& library, const std::filesystem::path& program) {
  struct stat of_library {
  }, of_program{};
  if (::stat(library.c_str(), &of_library) != 0 || ::stat(program.c_str(), &of_program) != 0) return;
  const bool has_owner = of_library.st_uid == 0 || of_library.st_uid == of_program.st_uid;
  if (has_owner && (of_library.st_mode & S_IWOTH) == 0) return;
  throw UserError(fmt::format(
      "--images: {} {}, so it is not loaded; install slom as a whole, or give the corners by "
      "--camera NAME=FILE",
      library.string(),
      has_owner ? "is writable by everybody" : "belongs neither to the owner of this program nor to root"));
}

std::filesystem::path detectorFile(const std::filesystem::path& program) {
  constexpr const char* name = "libslom_detect.so";
  if (!program.is_absolute()) {
    throw UserError(
        "--images: the system does not say where this program is installed, so libslom_detect.so, which "
        "finds boards, cannot be located; mount /proc, or give the corners by --camera NAME=FILE");
  }
  const std::filesystem::path built = SLOM_BUILT_DETECTOR_FOLDER, tree = SLOM_BUILD_TREE;
  const auto [end, unused] = std::mismatch(tree.begin(), tree.end(), program.begin(), program.end());
  if (end == tree.end()) return built / name;
  if (!isInstalled(program.parent_path())) {
    throw UserError(fmt::format(
        "--images: this program is not in its installation folder {}, so libslom_detect.so, which finds "
        "boards, cannot be located; install slom as a whole, or give the corners by --camera NAME=FILE",
        SLOM_COMMAND_FOLDER));
  }
  return (program.parent_path() / SLOM_LIBRARIES_FROM_COMMAND / name).lexically_normal();
}

std::vector<FoundCorner> findBoard(const Board& board, const Photograph& photo) {
  return module().find_board(board, photo);
}

bool showsChessboard(const Board& board, const Photograph& photo) {
  return module().shows_chessboard(board, photo);
}

ChessboardSize largestChessboard(const Photograph& photo) { return module().largest_chessboard(photo); }

std::vector<SeenMarker> seenMarkers(const std::string& dictionary, const Photograph& photo) {
  return module().seen_markers(dictionary, photo);
}

void requireDetector(const Board& board) {
  if (const std::string complaint = module().complaint(board); !complaint.empty()) throw UserError(complaint);
}

}  // namespace slom::app::calib
