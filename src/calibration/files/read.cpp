#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/files/csv.hpp"
#include "calibration/files/text.hpp"
#include "slom/calibration/files.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {

namespace {

constexpr std::size_t longest_comment = 80;  // in a message

/// Whether a comment is meant to state the size, however it is written: `Image size: 640x480`.
bool isAboutSize(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c == ' ' || c == '-' ? '_' : c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  });
  return text.starts_with("image_size") && text.find_first_of("0123456789") != std::string::npos;
}

/// `image_size_px: 640 x 480`
std::optional<ImageSize> sizeIn(const CsvTable& table, const CsvComment& comment) {
  constexpr std::string_view key = "image_size_px:";
  const bool has_key = comment.text.starts_with(key);
  if (!has_key && !isAboutSize(comment.text)) return {};
  if (has_key) {
    const std::string_view text = trimmed(std::string_view(comment.text).substr(key.size()));
    const std::size_t x = std::min(text.find('x'), text.size());
    ImageSize size;
    if (io::parseNumber(trimmed(text.substr(0, x)), size.width) && x < text.size() &&
        io::parseNumber(trimmed(text.substr(x + 1)), size.height) && isPlausible(size))
      return size;
  }
  badFile(
      fmt::format("{}:{}: the image size is \"{}\"; write it as in # image_size_px: 640 x 480, {} pixels at "
                  "most on a side",
                  table.file(), comment.line, shortened(comment.text, longest_comment), most_side_px));
}

/// `photo 7: left07.jpg`
void notePhoto(const CsvComment& comment, std::map<int, View>& views) {
  constexpr std::string_view key = "photo ";
  const std::size_t colon = comment.text.find(':');
  int image = 0;
  if (!comment.text.starts_with(key) || colon == std::string::npos) return;
  if (!io::parseNumber(std::string_view(comment.text).substr(key.size(), colon - key.size()), image)) return;
  if (const auto view = views.find(image); view != views.end())
    view->second.photo = trimmed(std::string_view(comment.text).substr(colon + 1));
}

}  // namespace

CameraData readCorners(const std::string& camera_name, const std::string& file) {
  const CsvTable table(file, {"image", "corner", "world_x_m", "world_y_m", "world_z_m", "u_px", "v_px"});
  std::map<int, View> views;
  std::map<std::pair<int, int>, int> line_of;  // (image, corner) -> line
  for (const CsvRow& row : table.rows()) {
    const int image = row.index(0), number = row.index(1);
    const auto [known, is_new] = line_of.emplace(std::pair(image, number), row.line());
    if (!is_new) {
      badFile(
          fmt::format("{}: corner {} of image {} was listed in line {} already; remove one of the two rows",
                      row.place(), number, image, known->second));
    }
    View& view = views[image];
    view.image = image;
    view.corners.push_back(
        {number,
         vec3(row.number(2, most_corner_m), row.number(3, most_corner_m), row.number(4, most_corner_m)),
         vec2(row.number(5, most_corner_px), row.number(6, most_corner_px)), row.line()});
  }
  CameraData camera{camera_name, file, {}, {}};
  for (const CsvComment& comment : table.comments()) {
    if (const auto size = sizeIn(table, comment)) camera.image_size = size;
    notePhoto(comment, views);
  }
  for (auto& [image, view] : views) camera.views.push_back(std::move(view));
  return camera;
}

CameraData readCorners(const std::string& camera_name, const std::vector<std::string>& files) {
  if (files.size() == 1) return readCorners(camera_name, files.front());
  if (files.empty()) badFile(fmt::format("camera {} has no file of corners; give at least one", camera_name));
  CameraData all{camera_name, fmt::format("{}", fmt::join(files, " ")), {}, {}};
  std::map<int, std::string> file_of;  // image -> file
  for (const std::string& file : files) {
    CameraData part = readCorners(camera_name, file);
    if (part.image_size && all.image_size &&
        (part.image_size->width != all.image_size->width ||
         part.image_size->height != all.image_size->height)) {
      badFile(fmt::format(
          "{}: images are of {} x {} pixels, but of {} x {} in a file before it; give files of one camera alone",
          file, part.image_size->width, part.image_size->height, all.image_size->width,
          all.image_size->height));
    }
    if (part.image_size) all.image_size = part.image_size;
    for (View& view : part.views) {
      const auto [known, is_new] = file_of.emplace(view.image, file);
      if (!is_new) {
        badFile(fmt::format(
            "{}:{}: image {} of camera {} is in {} already; number the images of all files differently, in all cameras alike, put the rows "
            "of one image into one file, or give the files as those of two cameras",
            file, view.corners.front().line, view.image, camera_name, known->second));
      }
      view.file = file;
      all.views.push_back(std::move(view));
    }
  }
  std::sort(all.views.begin(), all.views.end(),
            [](const View& a, const View& b) { return a.image < b.image; });
  return all;
}

ImuData readImu(const std::string& file) {
  const CsvTable table(file, {"image", "ax_m_s2", "ay_m_s2", "az_m_s2", "valid"});
  ImuData imu{file, {}};
  std::map<int, int> line_of;  // image -> line
  for (const CsvRow& row : table.rows()) {
    const int image = row.index(0), valid = row.index(4);
    if (valid > 1)
      badFile(fmt::format("{}: valid is \"{}\"; write 1, or 0 to skip the row", row.place(), valid));
    if (valid == 0) continue;
    const auto [known, is_new] = line_of.emplace(image, row.line());
    if (!is_new) {
      badFile(
          fmt::format("{}: image {} has a valid reading in line {} already; keep one, or the mean of both",
                      row.place(), image, known->second));
    }
    imu.readings.push_back({image,
                            vec3(row.number(1, most_reading_m_s2), row.number(2, most_reading_m_s2),
                                 row.number(3, most_reading_m_s2)),
                            row.line()});
  }
  if (imu.readings.empty()) {
    badFile(fmt::format("{}:{}: no row has valid = 1; leave out --imu, or mark the readings that can be used",
                        file, table.rows().back().line()));
  }
  return imu;
}

}  // namespace slom::calibration
