#include "calibrate/sources.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "error.hpp"
#include "plausible.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

bool isName(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  if (text.empty() || !letter(text.front())) return false;
  for (const char c : text) {
    if (!letter(c) && !(c >= '0' && c <= '9') && c != '-') return false;
  }
  return true;
}

/// Parses `NAME=FILE`. `example` shows how to write the option.
CameraFile parseNamed(const std::string& option, const std::string& text, const char* example) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size() || equals == 0) {
    throw UserError(fmt::format("{} {}: write {}", option, text, example));
  }
  const std::string name = text.substr(0, equals);
  if (!isName(name)) {
    throw UserError(
        fmt::format("{} {}: the name must begin with a letter and contain only letters, digits, _ and -; "
                    "rename the {}",
                    option, text, option.starts_with("--imu") ? "IMU" : "camera"));
  }
  return {name, text.substr(equals + 1)};
}

}  // namespace

NamedFileText parseNamedFile(const std::string& option, const std::string& text, const char* example) {
  const CameraFile named = parseNamed(option, text, example);
  return {named.name, named.file};
}

namespace {

/// Returns the camera of this name. Adds it if there is none.
CameraFile& withName(const std::string& name, std::vector<CameraFile>& cameras) {
  const auto known = std::find_if(cameras.begin(), cameras.end(),
                                  [&](const CameraFile& camera) { return camera.name == name; });
  return known != cameras.end() ? *known : cameras.emplace_back(CameraFile{name, "", {}, {}});
}

/// Returns the path that identifies the file, whatever path the user gave.
std::string realPath(const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path path = std::filesystem::canonical(file, ignored);
  return ignored ? file : path.string();
}

/// Throws if the file is a pattern that the shell left unchanged, as it does within a word.
void requireNoPattern(const std::string& text, const std::string& file) {
  std::error_code ignored;
  if (file.find_first_of("*?,") == std::string::npos || std::filesystem::exists(file, ignored)) return;
  throw UserError(fmt::format(
      "--camera {}: this file does not exist; pass --camera once for each file of a recording", text));
}

std::vector<CameraFile> parseCameras(const std::vector<std::string>& texts) {
  std::vector<CameraFile> cameras;
  std::map<std::string, std::string> camera_of;  // file -> camera
  for (const std::string& text : texts) {
    const CameraFile one = parseNamed("--camera", text, "NAME=FILE, as in --camera left=left_corners.csv");
    requireNoPattern(text, one.file);
    const auto [known, is_new] = camera_of.emplace(realPath(one.file), one.name);
    if (!is_new && known->second == one.name)
      throw UserError(
          fmt::format("--camera {}: the file is given twice; give it once, or another camera's file", text));
    if (!is_new)
      throw UserError(
          fmt::format("--camera {}: the file already belongs to camera {}; give each camera "
                      "its own",
                      text, known->second));
    withName(one.name, cameras).files.push_back(one.file);
  }
  for (CameraFile& camera : cameras) camera.file = fmt::format("{}", fmt::join(camera.files, " "));
  return cameras;
}

/// Parses the cameras. Words without a camera's name, as a shell makes of a pattern, belong to the camera before
/// them.
std::vector<CameraFile> parseImages(const std::vector<std::string>& words) {
  std::vector<CameraFile> cameras;
  std::size_t current = 0;
  for (const std::string& word : words) {
    if (!cameras.empty() && !isName(word.substr(0, std::min(word.find('='), word.size() - 1)))) {
      cameras[current].patterns.push_back(word);
      continue;
    }
    const CameraFile camera = parseNamed("--images", word, "NAME=PATTERN, as in --images left='left*.jpg'");
    CameraFile& named = withName(camera.name, cameras);
    current = std::size_t(&named - cameras.data());
    named.patterns.push_back(camera.file);
  }
  for (CameraFile& camera : cameras) camera.file = fmt::format("{}", fmt::join(camera.patterns, " "));
  return cameras;
}

}  // namespace

void parseSources(const RawOptions& raw, CommandSettings& settings) {
  if (!raw.cameras.empty() && !raw.images.empty()) {
    throw UserError(fmt::format(
        "--images {}: give --images or --camera, not both; --corners-out makes corner files of photographs",
        raw.images.front()));
  }
  if (raw.cameras.empty() && raw.images.empty()) {
    throw UserError(
        "no --camera; give at least one, as in --camera left=left_corners.csv, or photographs by --images");
  }
  settings.cameras = raw.images.empty() ? parseCameras(raw.cameras) : parseImages(raw.images);
  if (!raw.images.empty()) {
    settings.board = parseBoard(raw.board);
    return;
  }
  if (!settings.corners_folder.empty()) {
    throw UserError(
        fmt::format("--corners-out {}: needs photographs, none are given; add --images or drop this option",
                    settings.corners_folder));
  }
  settings.board_of_files = parseBoardOfFiles(raw.board);
}

std::map<std::string, ImageSize> parseImageSizes(const std::vector<std::string>& texts,
                                                 const std::vector<CameraFile>& cameras) {
  std::map<std::string, ImageSize> sizes;
  std::set<std::string> named;  // names with a size; "": the size for all other cameras
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    const std::string name = equals == std::string::npos ? "" : text.substr(0, equals);
    const std::string numbers = text.substr(equals == std::string::npos ? 0 : equals + 1);
    const auto x = numbers.find('x');
    ImageSize size;
    const bool is_read =
        x != std::string::npos && parseNumber(std::string_view(numbers).substr(0, x), size.width) &&
        parseNumber(std::string_view(numbers).substr(x + 1), size.height) && isPlausible(size);
    if (!is_read)
      throw UserError(
          fmt::format("--image-size {}: write NAME=WIDTHxHEIGHT, as in --image-size left=640x480, {} pixels "
                      "at most on a side",
                      text, most_side_px));
    if (!named.insert(name).second) {
      throw UserError(
          name.empty()
              ? fmt::format(
                    "--image-size {}: there are two sizes without a camera's name; write NAME=WIDTHxHEIGHT",
                    text)
              : fmt::format("--image-size {}: the size of camera {} is given twice; keep one", text, name));
    }
    std::vector<std::string> names;
    for (const CameraFile& camera : cameras) names.push_back(camera.name);
    if (name.empty()) {
      for (const std::string& camera : names) sizes.emplace(camera, size);
    } else if (std::find(names.begin(), names.end(), name) != names.end()) {
      sizes[name] = size;
    } else {
      throw UserError(fmt::format("--image-size {}: there is no camera {}; correct the name: {}", text, name,
                                  fmt::join(names, ", ")));
    }
  }
  return sizes;
}

}  // namespace slom::app::calib
