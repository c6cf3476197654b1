// Corners in files of OpenCV's FileStorage, as written by its calibration samples, or by users with the parameter
// names of OpenCV's functions.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/files/document.hpp"
#include "calibration/files/grid_file.hpp"
#include "calibration/files/text.hpp"

namespace slom::calibration {
namespace {

constexpr int most_board_side = 1000, most_entries = 100'000'000;
constexpr double not_metres = 0.5;  // squares at least this long are in another unit, or in none

/// Returns the key in lower case without underscores: `image_points`, `imagePoints` and `Image_Points` are one key.
std::string plainKey(std::string_view key) {
  std::string plain;
  for (const char c : key) {
    if (c != '_') plain += char(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

struct KeyedNode {
  std::string_view key;
  const Node* node = nullptr;
};

/// Returns the first entry with one of these keys.
KeyedNode entryOf(const Node& map, std::initializer_list<std::string_view> plain_keys) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    const std::string plain = plainKey(map.keys[i]);
    if (std::find(plain_keys.begin(), plain_keys.end(), plain) != plain_keys.end())
      return {map.keys[i], &map.items[i]};
  }
  return {};
}

/// Numbers, each with its line in the file.
struct Numbers {
  std::vector<double> values;
  std::vector<int> lines;
};

/// A file with the points of one or more images.
class Storage {
 public:
  Storage(const Document& document, const BoardOfFiles& board) : document_(document), board_(board) {}

  GridFile read() {
    const Node& root = document_.root;
    requireMap(root);
    const KeyedNode points = entryOf(root, {"imagepoints"});
    if (!points.node) failWithoutPoints(root);
    GridFile result{document_.file};
    result.image_size = imageSize(root);
    const std::vector<Numbers> pixels = byImage(points, 2, most_corner_px);
    const KeyedNode objects = entryOf(root, {"objectpoints"});
    const std::vector<std::vector<vec3>> world =
        objects.node ? objectPoints(objects, pixels) : grid(root, points, pixels);
    result.uses_board = !objects.node || board_.square_m > 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      GridImage image{std::to_string(i + 1)};
      const std::vector<vec3>& corners = world[std::min(i, world.size() - 1)];
      for (std::size_t k = 0; 2 * k < pixels[i].values.size(); ++k)
        image.corners.push_back({int(k) + 1, corners[k],
                                 vec2(pixels[i].values[2 * k], pixels[i].values[2 * k + 1]),
                                 pixels[i].lines[2 * k]});
      if (image.corners.empty()) image.unused = "has no corners";
      result.images.push_back(std::move(image));
    }
    nameImages(root, result.images);
    return result;
  }

 private:
  void requireMap(const Node& root) const {
    if (root.kind != Node::Kind::map)
      document_.fail(root.line, "the file has no keys; write image_points as cv::FileStorage does");
    if (const Node* const type = root.find("target_type"))
      document_.fail(type->line, "this is a target of Kalibr, without corners; give it as the board");
  }

  [[noreturn]] void failWithoutPoints(const Node& root) const {
    document_.fail(
        root.line,
        fmt::format(
            "the file has no key image_points, only {}; write the corners too, as OpenCV's calibration sample "
            "does with -op",
            shortened(fmt::format("{}", fmt::join(root.keys, ", ")), longest_quote)));
  }

  /// Appends a number, or all numbers of nested lists.
  void append(const Node& node, std::string_view key, double most, Numbers& numbers) const {
    if (node.kind == Node::Kind::map) return appendMatrix(node, key, most, numbers);
    if (node.kind == Node::Kind::list) {
      for (const Node& item : node.items) append(item, key, most, numbers);
    } else if (!node.text.empty()) {
      numbers.values.push_back(document_.number(node, key, most));
      numbers.lines.push_back(node.line);
    }
  }

  const Node& valueOf(const Node& matrix, std::string_view key, std::string_view of) const {
    const Node* const found = matrix.find(key);
    if (!found)
      document_.fail(matrix.line,
                     fmt::format("a matrix of {} has no {}; write it as cv::FileStorage does", of, key));
    return *found;
  }

  /// Returns the sides of a matrix, followed by its number of channels.
  std::vector<int> shapeOf(const Node& matrix, std::string_view key) const {
    std::vector<int> shape;
    if (const Node* const sizes = matrix.find("sizes")) {
      const bool is_list = sizes->kind == Node::Kind::list;
      for (std::size_t i = 0; i < (is_list ? sizes->items.size() : 1); ++i)
        shape.push_back(document_.whole(is_list ? sizes->items[i] : *sizes, "sizes", 0, most_entries));
    } else {
      for (const char* const side : {"rows", "cols"})
        shape.push_back(document_.whole(valueOf(matrix, side, key), side, 0, most_entries));
    }
    const Node& type = valueOf(matrix, "dt", key);
    if (type.kind != Node::Kind::scalar || type.text.empty())
      document_.fail(type.line, "dt is not a type; write it as cv::FileStorage does");
    const std::string_view digits = type.text.substr(0, type.text.size() - 1);
    shape.push_back(
        digits.empty() ? 1 : document_.whole(Node{Node::Kind::scalar, type.line, digits}, "dt", 1, 4));
    return shape;
  }

  void appendMatrix(const Node& matrix, std::string_view key, double most, Numbers& numbers) const {
    double expected = 1;
    for (const int side : shapeOf(matrix, key)) expected *= side;
    const std::size_t before = numbers.values.size();
    const Node& data = valueOf(matrix, "data", key);
    if (data.kind == Node::Kind::map)
      document_.fail(data.line, "data is not a list of numbers; write it as cv::FileStorage does");
    append(data, key, most, numbers);
    if (const std::size_t count = numbers.values.size() - before; double(count) != expected)
      document_.fail(data.line,
                     fmt::format("{} has {} numbers, but rows, cols and dt give {}; copy the file again", key,
                                 count, expected));
  }

  /// Cuts one list of the numbers of all images into a list for each image.
  std::vector<Numbers> cut(const Numbers& all, std::size_t images) const {
    std::vector<Numbers> parts(images);
    const std::size_t each = images == 0 ? 0 : all.values.size() / images;
    for (std::size_t i = 0; i < images; ++i) {
      const auto first = std::ptrdiff_t(i * each), last = std::ptrdiff_t((i + 1) * each);
      parts[i].values.assign(all.values.begin() + first, all.values.begin() + last);
      parts[i].lines.assign(all.lines.begin() + first, all.lines.begin() + last);
    }
    return parts;
  }

  /// Returns the numbers of each image, `dimension` for each point. Takes a matrix with a row for each image, or a
  /// list with an entry for each.
  std::vector<Numbers> byImage(const KeyedNode& entry, std::size_t dimension, double most) const {
    const Node& node = *entry.node;
    std::vector<Numbers> images;
    if (node.kind == Node::Kind::map) {
      Numbers all;
      append(node, entry.key, most, all);
      if (!all.values.empty()) images = cut(all, std::size_t(shapeOf(node, entry.key).front()));
    } else if (node.kind == Node::Kind::list) {
      for (const Node& item : node.items) {
        if (item.kind == Node::Kind::scalar && !item.text.empty())
          document_.fail(
              item.line,
              fmt::format("{} is one list of numbers; write a list of points for each image", entry.key));
        append(item, entry.key, most, images.emplace_back());
      }
    }
    if (images.empty())
      document_.fail(node.line,
                     fmt::format("{} has no images; write a list of points for each image", entry.key));
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (images[i].values.size() % dimension == 0) continue;
      document_.fail(images[i].lines.front(),
                     fmt::format("{} of image {} are {} numbers, not {} for each point; copy the file again",
                                 entry.key, i + 1, images[i].values.size(), dimension));
    }
    return images;
  }

  /// Joins a list of single points into one board.
  static std::vector<Numbers> inOne(std::vector<Numbers> entries) {
    const bool are_points = std::all_of(entries.begin(), entries.end(),
                                        [](const Numbers& one) { return one.values.size() == 3; });
    if (!are_points) return entries;
    for (std::size_t i = 1; i < entries.size(); ++i)
      entries[0].values.insert(entries[0].values.end(), entries[i].values.begin(), entries[i].values.end());
    entries.resize(1);
    return entries;
  }

  /// Returns the points of each image, or one list of points for all images.
  std::vector<std::vector<vec3>> objectPoints(const KeyedNode& entry,
                                              const std::vector<Numbers>& pixels) const {
    const std::vector<Numbers> numbers = inOne(byImage(entry, 3, most_corner_m));
    if (numbers.size() != 1 && numbers.size() != pixels.size())
      document_.fail(entry.node->line, fmt::format("{} has points of {} images, image_points of {}; write "
                                                   "points of the same images",
                                                   entry.key, numbers.size(), pixels.size()));
    std::vector<std::vector<vec3>> world;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Numbers& image : numbers) {
      std::vector<vec3>& points = world.emplace_back();
      for (std::size_t k = 0; k + 2 < image.values.size(); k += 3) {
        points.emplace_back(image.values[k], image.values[k + 1], image.values[k + 2]);
        if (points.size() < 2) continue;
        if (const double apart = (points.back() - points[points.size() - 2]).norm(); apart > 0)
          nearest = std::min(nearest, apart);
      }
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::size_t corners = pixels[i].values.size() / 2,
                        known = world[std::min(i, world.size() - 1)].size();
      if (corners == known || corners == 0) continue;
      document_.fail(pixels[i].lines.front(),
                     fmt::format("image {} has {} image points and {} {}; write the same number of each",
                                 i + 1, corners, known, entry.key));
    }
    scale(world, nearest, entry);
    return world;
  }

  /// Converts to metres. The smallest distance between successive points is the side of a square.
  void scale(std::vector<std::vector<vec3>>& world, double nearest, const KeyedNode& entry) const {
    if (board_.square_m > 0 && std::isfinite(nearest)) {
      for (auto& points : world) {
        for (vec3& point : points) point *= board_.square_m / nearest;
      }
    } else if (nearest >= not_metres && std::isfinite(nearest)) {
      failUnit(entry.node->line, fmt::format("{} are {:g} apart", entry.key, nearest));
    }
  }

  [[noreturn]] void failUnit(int line, const std::string& what) const {
    throw DataError("slom.calibration.no-board", {.place = fmt::format("{}:{}", document_.file, line),
                                                  .fault = what + " without a unit, and metres are unlikely",
                                                  .remedy = "state the side of a square in BoardOfFiles"});
  }

  /// Returns the points of a board of the size stated by the file or the user. If both state a size, they must agree.
  std::vector<std::vector<vec3>> grid(const Node& root, const KeyedNode& points,
                                      const std::vector<Numbers>& pixels) const {
    BoardOfFiles board = board_;
    const KeyedNode width = entryOf(root, {"boardwidth"}), height = entryOf(root, {"boardheight"}),
                    square = entryOf(root, {"squaresize"});
    if (width.node && height.node) {
      const int columns = document_.whole(*width.node, width.key, 1, most_board_side),
                rows = document_.whole(*height.node, height.key, 1, most_board_side);
      if (board_.columns > 0 && (columns != board_.columns || rows != board_.rows))
        document_.fail(
            width.node->line,
            fmt::format("the file has a board of {} x {} corners, but {} x {} are stated; correct one of "
                        "them",
                        columns, rows, board_.columns, board_.rows));
      board.columns = columns, board.rows = rows;
    }
    if (square.node && !(board_.square_m > 0) && board_.points.empty()) {
      board.square_m = document_.number(*square.node, square.key, most_corner_m);
      if (!(board.square_m > 0))
        document_.fail(square.node->line,
                       fmt::format("{} is {:g}; write a positive number", square.key, board.square_m));
      if (board.square_m >= not_metres)
        failUnit(square.node->line, fmt::format("{} is {:g}", square.key, board.square_m));
    }
    std::vector<vec3> corners = pointsOf(board, document_.file);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::size_t count = pixels[i].values.size() / 2;
      if (count == corners.size() || count == 0) continue;
      document_.fail(pixels[i].lines.front(),
                     fmt::format("{} of image {}: {} points, but the board has {} x {} corners; correct "
                                 "the size of the board",
                                 points.key, i + 1, count, board.columns, board.rows));
    }
    return {std::move(corners)};
  }

  std::optional<ImageSize> imageSize(const Node& root) const {
    const KeyedNode width = entryOf(root, {"imagewidth"}), height = entryOf(root, {"imageheight"});
    if (width.node && height.node)
      return ImageSize{document_.whole(*width.node, width.key, 1, most_side_px),
                       document_.whole(*height.node, height.key, 1, most_side_px)};
    const KeyedNode both = entryOf(root, {"imagesize"});
    if (!both.node || both.node->kind != Node::Kind::list || both.node->items.size() != 2) return {};
    return ImageSize{document_.whole(both.node->items[0], both.key, 1, most_side_px),
                     document_.whole(both.node->items[1], both.key, 1, most_side_px)};
  }

  /// Names the images by the file's list of names, if there is one.
  void nameImages(const Node& root, std::vector<GridImage>& images) const {
    const KeyedNode names =
        entryOf(root, {"imagelist", "images", "imagenames", "imagefiles", "filenames", "files"});
    if (!names.node || names.node->kind == Node::Kind::map) return;
    const bool is_list = names.node->kind == Node::Kind::list;
    const std::size_t count = is_list ? names.node->items.size() : 1;
    if (count != images.size())
      document_.fail(names.node->line, fmt::format("{} names {} images, image_points has {}; write the "
                                                   "same number of each",
                                                   names.key, count, images.size()));
    for (std::size_t i = 0; i < count; ++i)
      images[i].name = (is_list ? names.node->items[i] : *names.node).text;
    numberByNames(document_.file, images);
  }

  const Document& document_;
  const BoardOfFiles& board_;
};

}  // namespace

GridFile readFileStorage(const std::string& file, std::string text, FileFormat format,
                         const BoardOfFiles& board) {
  Document document(file, std::move(text));
  if (format == FileFormat::xml)
    parseXml(document);
  else
    parseYaml(document);
  return Storage(document, board).read();
}

}  // namespace slom::calibration
