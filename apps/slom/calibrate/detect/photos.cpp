#include "calibrate/detect/photos.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <glob.h>
#include <map>
#include <set>

#include <fmt/format.h>

#include "error.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Returns the photographs of a folder, in alphabetical order. EuRoC's folders of cameras have theirs in `data`.
std::vector<std::string> photosIn(const std::filesystem::path& folder) {
  std::error_code ignored;
  const std::filesystem::path data = folder / "data";
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::is_directory(data, ignored) ? data : folder, ignored)) {
    std::string ending = entry.path().extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    for (const char* const known : {".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".tif", ".tiff"}) {
      if (ending == known) files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Returns the files that match one pattern, or the photographs of a folder, in alphabetical order. If a file has the name
/// of the pattern, returns that file.
std::vector<std::string> expanded(const std::string& camera, const std::string& pattern) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(pattern, ignored)) return {pattern};
  if (std::filesystem::is_directory(pattern, ignored)) {
    if (std::vector<std::string> files = photosIn(pattern); !files.empty()) return files;
    throw UserError(fmt::format(
        "--images {}={}: the folder has no photographs, nor has its folder data; correct the folder", camera,
        pattern));
  }
  glob_t found{};
  const int status = ::glob(pattern.c_str(), GLOB_TILDE, nullptr, &found);
  std::vector<std::string> files;
  if (status == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      if (!std::filesystem::is_directory(found.gl_pathv[i], ignored)) files.emplace_back(found.gl_pathv[i]);
    }
  }
  ::globfree(&found);
  if (!files.empty()) return files;
  throw UserError(fmt::format(
      "--images {}={}: no file matches this; check the folder and the pattern, and quote it so that the "
      "shell leaves it alone",
      camera, pattern));
}

/// Compares numbers given as texts without leading zeros: the shorter one is smaller.
struct ByValue {
  bool operator()(const std::string& a, const std::string& b) const {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  }
};

using FilesByNumber = std::map<std::string, std::string, ByValue>;

/// Returns the files by number. Files without a number go to `unnumbered`.
FilesByNumber numbered(const CameraFile& camera, std::vector<std::string>& unnumbered) {
  FilesByNumber files;
  for (const std::string& pattern : camera.patterns) {
    for (const std::string& file : expanded(camera.name, pattern)) {
      const std::string number = numberInName(file);
      if (number.empty()) {
        if (std::find(unnumbered.begin(), unnumbered.end(), file) == unnumbered.end())
          unnumbered.push_back(file);
        continue;
      }
      const auto [known, is_new] = files.emplace(number, file);
      if (is_new || known->second == file) continue;
      throw UserError(fmt::format(
          "{}: camera {} already has image {}, {}; the last number in the name must distinguish its "
          "photographs",
          file, camera.name, number, known->second));
    }
  }
  if (files.empty()) {
    throw UserError(fmt::format(
        "{}: no photograph of camera {} has a number in its name to pair photographs taken at the same "
        "time; rename them, as in {}07.jpg",
        unnumbered.front(), camera.name, camera.name));
  }
  return files;
}

void requireOneCamera(const std::vector<CameraFile>& cameras, const std::vector<FilesByNumber>& files) {
  std::map<std::string, std::string> camera_of;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (const auto& [number, file] : files[c]) {
      const auto [known, is_new] = camera_of.emplace(file, cameras[c].name);
      if (is_new) continue;
      throw UserError(
          fmt::format("{}: camera {} and camera {} both have this photograph; correct the patterns", file,
                      known->second, cameras[c].name));
    }
  }
}

}  // namespace

std::string numberInName(const std::string& file) {
  const std::string name = std::filesystem::path(file).stem();
  const auto last = std::find_if(name.rbegin(), name.rend(), isDigit);
  const auto before = std::find_if_not(last, name.rend(), isDigit);
  std::string number(before.base(), last.base());
  number.erase(0, std::min(number.find_first_not_of('0'), number.empty() ? 0 : number.size() - 1));
  return number;
}

std::vector<CameraPhotos> findPhotos(const std::vector<CameraFile>& cameras, ImageNumbers* found) {
  std::vector<FilesByNumber> files;
  std::vector<std::vector<std::string>> unnumbered;
  for (const CameraFile& camera : cameras) files.push_back(numbered(camera, unnumbered.emplace_back()));
  requireOneCamera(cameras, files);
  std::vector<std::vector<std::string>> numbers;
  for (const FilesByNumber& camera : files) {
    numbers.emplace_back();
    for (const auto& [number, file] : camera) numbers.back().push_back(number);
  }
  const ImageNumbers images(numbers);
  if (found) *found = images;
  std::vector<CameraPhotos> result;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    CameraPhotos camera{cameras[c].name, {}, std::move(unnumbered[c])};
    for (const auto& [number, file] : files[c]) camera.photos.push_back({images.of(c, number), file});
    result.push_back(std::move(camera));
  }
  return result;
}

}  // namespace slom::app::calib
