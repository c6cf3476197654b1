#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/files/csv.hpp"
#include "calibration/files/grid_file.hpp"
#include "calibration/files/text.hpp"
#include "slom/calibration/files.hpp"
#include "slom/io/input_file.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {

namespace {

constexpr std::size_t longest_comment = 80;  // in a message

/// Returns whether a comment means to state the size, in any spelling: `Image size: 640x480`.
bool isAboutSize(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c == ' ' || c == '-' ? '_' : c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  });
  return text.starts_with("image_size") && text.find_first_of("0123456789") != std::string::npos;
}

/// Reads `image_size_px: 640 x 480`.
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

/// Maps a number in a file to an image number; nothing if no row of the file has that number.
using ImageOf = std::function<std::optional<int>(const std::string& digits)>;

/// Reads `photo 7: left07.jpg`.
void notePhoto(const CsvComment& comment, const ImageOf& image_of, std::map<int, View>& views) {
  constexpr std::string_view key = "photo ";
  const std::size_t colon = comment.text.find(':');
  if (!comment.text.starts_with(key) || colon == std::string::npos) return;
  const std::optional<int> image =
      image_of(std::string(trimmed(std::string_view(comment.text).substr(key.size(), colon - key.size()))));
  if (!image) return;
  if (const auto view = views.find(*image); view != views.end())
    view->second.photo = trimmed(std::string_view(comment.text).substr(colon + 1));
}

}  // namespace

namespace {

const std::vector<std::string> corner_columns{"image",     "corner", "world_x_m", "world_y_m",
                                              "world_z_m", "u_px",   "v_px"},
    imu_columns{"image", "ax_m_s2", "ay_m_s2", "az_m_s2", "valid"};

/// A table of corners: what its first column counts, and whether it states where the corners lie.
struct CornerTable {
  CsvTable table;
  std::optional<TimeUnit> unit;  ///< of times; nothing: it has image numbers
  bool has_world = true;

  CornerTable(const std::string& file, std::string text)
      : CornerTable(file, columnsOf(text), std::move(text)) {}

  /// Returns the digits of the image number or time of a row.
  std::string digits(const CsvRow& row) const { return unit ? row.nanoseconds(0, *unit) : row.digits(0); }
  /// Returns the time of a row, if the first column has times. Numbers of images that are as long as the time since
  /// 1970 are times, too.
  std::optional<std::int64_t> time(const std::string& digits) const {
    std::int64_t time = 0;
    if (!unit) return timeInDigits(digits);
    return io::parseNumber(digits, time) ? std::optional(time) : std::nullopt;
  }

 private:
  static std::optional<TimeUnit> timeIn(const std::vector<std::string>& header) {
    return header.empty() ? std::nullopt : timeUnitIn(header.front());
  }
  /// Returns the columns that a file with a header of this form should have: with times if it has some, and without places
  /// on the board if it has four columns.
  static std::vector<std::string> expected(const std::vector<std::string>& header) {
    std::vector<std::string> all = corner_columns;
    if (timeIn(header)) all.front() = header.front();
    const std::vector<std::string> without{all[0], all[1], all[5], all[6]};
    return header.size() == without.size() ? without : all;
  }
  CornerTable(const std::string& file, const std::vector<std::string>& header, std::string&& text)
      : table(file, std::move(text), expected(header)),
        unit(timeIn(header)),
        has_world(header.size() == corner_columns.size()) {}
};

/// Returns the image numbers of the rows that count, each once.
std::vector<std::string> numbersIn(const CsvTable& table, const std::function<bool(const CsvRow&)>& counts) {
  std::set<std::string> numbers;
  for (const CsvRow& row : table.rows()) {
    if (counts(row)) numbers.insert(row.digits(0));
  }
  return {numbers.begin(), numbers.end()};
}
std::vector<std::string> numbersIn(const CornerTable& corners) {
  std::set<std::string> numbers;
  for (const CsvRow& row : corners.table.rows()) numbers.insert(corners.digits(row));
  return {numbers.begin(), numbers.end()};
}

/// Refuses readings of an IMU in motion, whose rows begin with a time.
void refuseStream(const std::string& file, const std::string& text) {
  const std::string_view header = std::string_view(text).substr(0, text.find_first_of("\r\n"));
  const std::size_t first = header.starts_with('#') ? 1 : 0;
  if (timeUnitIn(trimmed(header.substr(first, header.find_first_of(",;\t") - first))))
    badFile(fmt::format(
        "{}:1: the rows begin with times, as those of an IMU in motion; give --imu-stream imu0={}, or a file "
        "with the columns {}",
        file, file, fmt::join(imu_columns, ",")));
}

bool isValid(const CsvRow& row) {
  const int valid = row.index(4);
  if (valid > 1)
    badFile(fmt::format("{}: valid is \"{}\"; write 1, or 0 to skip the row", row.place(), valid));
  return valid == 1;
}

/// Returns the place of a corner: that of its row, or that of its number on the board.
vec3 worldOf(const CsvRow& row, bool has_world, const std::vector<vec3>& board) {
  if (has_world)
    return vec3(row.number(2, most_corner_m), row.number(3, most_corner_m), row.number(4, most_corner_m));
  const int number = row.index(1);
  if (std::size_t(number) < board.size()) return board[std::size_t(number)];
  badFile(fmt::format(
      "{}: the board has {} corners and no corner {}; correct the number, or the size of the board",
      row.place(), board.size(), number));
}

CameraData cornersIn(const CornerTable& corners, const std::string& camera_name, const ImageOf& image_of,
                     const std::vector<vec3>& board) {
  const CsvTable& table = corners.table;
  const std::size_t u = corners.has_world ? 5 : 2;
  std::map<int, View> views;
  std::map<std::pair<int, int>, int> line_of;  // (image, corner) -> line
  for (const CsvRow& row : table.rows()) {
    const std::string digits = corners.digits(row);
    const int image = *image_of(digits), number = row.index(1);
    const auto [known, is_new] = line_of.emplace(std::pair(image, number), row.line());
    if (!is_new) {
      badFile(
          fmt::format("{}: corner {} of image {} was listed in line {} already; remove one of the two rows",
                      row.place(), number, image, known->second));
    }
    View& view = views[image];
    view.image = image;
    if (view.corners.empty()) view.time_ns = corners.time(digits);
    view.corners.push_back({number, worldOf(row, corners.has_world, board),
                            vec2(row.number(u, most_corner_px), row.number(u + 1, most_corner_px)),
                            row.line()});
  }
  CameraData camera{camera_name, table.file(), {}, {}};
  for (const CsvComment& comment : table.comments()) {
    if (const auto size = sizeIn(table, comment)) camera.image_size = size;
    notePhoto(comment, image_of, views);
  }
  for (auto& [image, view] : views) camera.views.push_back(std::move(view));
  return camera;
}

CameraData cornersIn(const GridFile& grid, const std::string& camera_name, const ImageOf& image_of) {
  CameraData camera{camera_name, grid.file, {}, grid.image_size};
  std::map<int, const GridImage*> image_with;
  for (const GridImage& image : grid.images) {
    const int number = *image_of(image.digits);
    const auto [known, is_new] = image_with.emplace(number, &image);
    if (!is_new)
      badFile(fmt::format("{}: images {} and {} are both image {}; number them differently", grid.file,
                          shortened(known->second->name, longest_comment),
                          shortened(image.name, longest_comment), number));
    if (image.unused.empty())
      camera.views.push_back({number, image.corners, image.name});
    else
      camera.unused.push_back(
          {number, image.name.empty() ? fmt::format("image {}", number) : image.name, image.unused});
  }
  if (camera.views.empty()) badFile(fmt::format("{}: no image has corners; detect some", grid.file));
  std::sort(camera.views.begin(), camera.views.end(),
            [](const View& a, const View& b) { return a.image < b.image; });
  std::sort(camera.unused.begin(), camera.unused.end(),
            [](const UnusedPhoto& a, const UnusedPhoto& b) { return a.image < b.image; });
  return camera;
}

/// Joins the parts of one camera's recording.
CameraData joined(const std::string& camera_name, const std::vector<std::string>& files,
                  std::vector<CameraData> parts) {
  if (parts.size() == 1) return std::move(parts.front());
  CameraData all{camera_name, fmt::format("{}", fmt::join(files, " ")), {}, {}};
  std::map<int, std::string> file_of;  // image -> file
  for (CameraData& part : parts) {
    const std::string& file = part.file;
    if (part.image_size && all.image_size &&
        (part.image_size->width != all.image_size->width ||
         part.image_size->height != all.image_size->height)) {
      badFile(fmt::format(
          "{}: images have {} x {} pixels, but {} x {} in an earlier file; give files of only one camera",
          file, part.image_size->width, part.image_size->height, all.image_size->width,
          all.image_size->height));
    }
    if (part.image_size) all.image_size = part.image_size;
    for (View& view : part.views) {
      const auto [known, is_new] = file_of.emplace(view.image, file);
      if (!is_new) {
        badFile(fmt::format(
            "{}:{}: image {} of camera {} is already in {}; number images differently in all files and "
            "alike in all cameras, put the rows of one image into one file, or give the files as two "
            "cameras",
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

ImuData readingsIn(const CsvTable& table, const ImageOf& image_of) {
  ImuData imu{table.file(), {}};
  std::map<int, int> line_of;  // image -> line
  for (const CsvRow& row : table.rows()) {
    if (!isValid(row)) continue;
    const int image = *image_of(row.digits(0));
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
    badFile(fmt::format("{}:{}: no row has valid = 1; drop --imu, or mark usable readings", table.file(),
                        table.rows().back().line()));
  }
  return imu;
}

}  // namespace

namespace {

/// Returns the places of corners by their numbers, for a table that does not state them.
std::vector<vec3> numberedPoints(const BoardOfFiles& board, const std::string& file) {
  return board.numbered.empty() ? pointsOf(board, file) : board.numbered;
}

/// One file of corners: a table, or a file of another program.
struct CornerFile {
  std::unique_ptr<CornerTable> table;
  std::vector<vec3> board;  ///< of a table without places of the corners
  std::optional<GridFile> grid;

  CornerFile(const std::string& file, const BoardOfFiles& given) {
    std::string text = io::readWhole(file);
    const FileFormat format = formatOf(text);
    if (format == FileFormat::table) {
      table = std::make_unique<CornerTable>(file, std::move(text));
      if (!table->has_world) board = numberedPoints(given, file);
    } else if (format == FileFormat::vnlog) {
      grid = readVnlog(file, text, given);
    } else {
      grid = readFileStorage(file, std::move(text), format, given);
    }
  }

  bool usesBoard() const { return grid ? grid->uses_board : !table->has_world; }

  std::vector<std::string> numbers() const {
    if (table) return numbersIn(*table);
    std::vector<std::string> digits;
    for (const GridImage& image : grid->images) digits.push_back(image.digits);
    return digits;
  }

  CameraData camera(const std::string& name, const ImageOf& image_of) const {
    return table ? cornersIn(*table, name, image_of, board) : cornersIn(*grid, name, image_of);
  }
};

/// The files of a rig, read but not yet joined, because image numbers may be time stamps paired across all files.
struct RigFiles {
  std::vector<std::vector<CornerFile>> cameras;
  std::unique_ptr<CsvTable> readings;
  std::vector<std::vector<std::string>> numbers;  // by camera, and last of the IMU

  RigFiles(const std::vector<CameraFiles>& files, const std::string& imu_file, const BoardOfFiles& board) {
    for (const CameraFiles& camera : files) {
      if (camera.files.empty())
        badFile(fmt::format("camera {} has no file of corners; give at least one", camera.name));
      std::vector<CornerFile>& own = cameras.emplace_back();
      std::vector<std::string>& found = numbers.emplace_back();
      for (const std::string& file : camera.files) {
        for (std::string& number : own.emplace_back(file, board).numbers())
          found.push_back(std::move(number));
      }
      std::sort(found.begin(), found.end());
      found.erase(std::unique(found.begin(), found.end()), found.end());
    }
    if (imu_file.empty()) return;
    std::string text = io::readWhole(imu_file);
    refuseStream(imu_file, text);
    readings = std::make_unique<CsvTable>(imu_file, std::move(text), imu_columns);
    numbers.push_back(numbersIn(*readings, isValid));
  }

  bool useBoard() const {
    return std::any_of(cameras.begin(), cameras.end(), [](const auto& files) {
      return std::any_of(files.begin(), files.end(), [](const CornerFile& file) { return file.usesBoard(); });
    });
  }
};

Dataset putTogether(const std::vector<CameraFiles>& cameras, const RigFiles& files, ImageNumbers* found) {
  const ImageNumbers images(files.numbers);
  const auto imageOf = [&](std::size_t source) {
    return [&, source](const std::string& digits) -> std::optional<int> {
      const std::vector<std::string>& own = files.numbers[source];
      if (!std::binary_search(own.begin(), own.end(), digits)) return {};
      return images.of(source, digits);
    };
  };
  Dataset data;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    std::vector<CameraData> parts;
    for (const CornerFile& file : files.cameras[c]) parts.push_back(file.camera(cameras[c].name, imageOf(c)));
    data.cameras.push_back(joined(cameras[c].name, cameras[c].files, std::move(parts)));
  }
  if (files.readings) data.imu = readingsIn(*files.readings, imageOf(cameras.size()));
  if (found) *found = images;
  return data;
}

}  // namespace

Dataset readRig(const std::vector<CameraFiles>& cameras, const std::string& imu_file, ImageNumbers* found) {
  return putTogether(cameras, RigFiles(cameras, imu_file, {}), found);
}

Dataset readRig(const std::vector<CameraFiles>& cameras, const std::string& imu_file,
                const BoardOfFiles& board, ImageNumbers* found) {
  const RigFiles files(cameras, imu_file, board);
  if (!files.useBoard())
    throw DataError("slom.calibration.unused-board",
                    {.place = cameras.empty() ? "" : cameras.front().files.front(),
                     .fault = "the corner files already state where their corners lie",
                     .remedy = "state no board"});
  return putTogether(cameras, files, found);
}

CameraData readCorners(const std::string& camera_name, const std::string& file) {
  return readCorners(camera_name, std::vector<std::string>{file});
}

CameraData readCorners(const std::string& camera_name, const std::vector<std::string>& files) {
  return std::move(readRig({{camera_name, files}}, "").cameras.front());
}

ImuData readImu(const std::string& file) { return std::move(*readRig({}, file).imu); }

}  // namespace slom::calibration
