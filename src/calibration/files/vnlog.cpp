// Corners as mrcal and mrgingham write them: a vnlog table of columns filename, x, y and level or weight, with the
// corners of an image row by row.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "calibration/files/grid_file.hpp"
#include "calibration/files/text.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t no_column = std::string_view::npos;

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  while (!(line = trimmed(line)).empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

class Vnlog {
 public:
  Vnlog(const std::string& file, std::string_view text, const BoardOfFiles& board)
      : file_(file), text_(text), points_(pointsOf(board, file)) {}

  GridFile read() {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
    while (!text_.empty()) {
      const std::size_t end = std::min(text_.find_first_of("\r\n"), text_.size());
      std::string_view line = text_.substr(0, end);
      text_.remove_prefix(std::min(end + (text_.substr(end).starts_with("\r\n") ? 2 : 1), text_.size()));
      ++line_;
      if (columns_ == 0 && line.starts_with('#') && !line.starts_with("##") && !line.starts_with("#!")) {
        readLegend(wordsOf(line.substr(1)));
        continue;
      }
      line = line.substr(0, line.find('#'));
      if (const auto words = wordsOf(line); !words.empty()) readRow(words);
    }
    GridFile result{file_};
    result.uses_board = true;
    for (Seen& image : seen_) result.images.push_back(finished(image));
    if (result.images.empty())
      badFile(fmt::format("{}:{}: there are no corners below the legend; detect some", file_, line_));
    numberByNames(file_, result.images);
    return result;
  }

 private:
  /// The rows of an image.
  struct Seen {
    std::string name;
    int first_line = 0;
    std::size_t rows = 0;
    std::vector<Corner> corners{};
  };

  [[noreturn]] void fail(const std::string& sentence) const {
    badFile(fmt::format("{}:{}: {}", file_, line_, sentence));
  }

  void readLegend(const std::vector<std::string_view>& names) {
    const auto place = [&](std::string_view name) -> std::size_t {
      const auto found = std::find(names.begin(), names.end(), name);
      return found == names.end() ? no_column : std::size_t(found - names.begin());
    };
    columns_ = names.size();
    filename_ = place("filename"), x_ = place("x"), y_ = place("y"), level_ = place("level"),
    weight_ = place("weight");
    if (level_ != no_column && weight_ != no_column)
      fail("there are both columns level and weight; keep one");
    const std::size_t last = std::max({filename_, x_, y_});
    if (last == no_column) fail("the legend must name the columns filename, x and y");
    fewest_ = last + 1;
  }

  void readRow(const std::vector<std::string_view>& words) {
    const bool is_none = words.size() > std::max(x_, y_) && words[x_] == "-" && words[y_] == "-";
    if (words.size() != columns_ && !(is_none && words.size() >= fewest_))
      fail(fmt::format("the row has {} words, the legend {}; the file may be cut off, so copy it again",
                       words.size(), columns_));
    Seen& image = seenIn(words[filename_]);
    if (++image.rows > points_.size())
      fail(fmt::format("this is corner {} of image {}, and the board has {}; correct the size of the board",
                       image.rows, shortened(image.name, longest_quote), points_.size()));
    const std::optional<double> sigma = is_none ? std::nullopt : sigmaOf(words);
    if (!sigma) return;
    const std::size_t index = image.rows - 1;
    image.corners.push_back({int(index) + 1, points_[index],
                             vec2(coordinate("x", words[x_]), coordinate("y", words[y_])), line_, *sigma});
  }

  Seen& seenIn(std::string_view name) {
    const auto [known, is_new] = place_of_.emplace(std::string(name), seen_.size());
    if (is_new) {
      seen_.push_back({std::string(name), line_});
    } else if (known->second + 1 != seen_.size()) {
      fail(fmt::format("image {} has rows above, from line {} on, and again here; keep one detection of it",
                       shortened(name, longest_quote), seen_[known->second].first_line));
    }
    return seen_.back();
  }

  double coordinate(const char* column, std::string_view word) const {
    double value = 0;
    if (!io::parseNumber(word, value) || !(std::abs(value) <= most_corner_px))
      fail(fmt::format("{} is \"{}\"; write a finite number, or - for a corner that was not found", column,
                       shortened(word, longest_quote)));
    return value;
  }

  /// Returns the sigma of a corner relative to the other corners; nothing if the corner does not count.
  std::optional<double> sigmaOf(const std::vector<std::string_view>& words) const {
    const std::size_t column = level_ != no_column ? level_ : weight_;
    if (column == no_column) return 1;
    const std::string_view word = words[column];
    if (word == "-") return {};
    double value = 0;
    const char* const name = level_ != no_column ? "level" : "weight";
    if (!io::parseNumber(word, value) || !std::isfinite(value))
      fail(fmt::format("{} is \"{}\"; write a finite number, or - to skip the corner", name,
                       shortened(word, longest_quote)));
    if (value < 0 || (level_ == no_column && value == 0)) return {};
    const double sigma = level_ != no_column ? std::exp2(value) : 1 / value;
    if (sigma < least_corner_sigma || sigma > most_corner_sigma)
      fail(fmt::format(
          "{} is \"{}\", which makes the corner {:.3g} times as uncertain as others; write - to skip it",
          name, shortened(word, longest_quote), sigma));
    return sigma;
  }

  GridImage finished(Seen& image) const {
    GridImage result{"", image.name, std::move(image.corners)};
    if (result.corners.empty()) {
      result.unused = "shows no board";
    } else if (image.rows != points_.size()) {
      badFile(fmt::format(
          "{}:{}: image {} has {} corners, and the board has {}; correct the size of the board, or copy the file "
          "again if it is cut off",
          file_, image.first_line, shortened(image.name, longest_quote), image.rows, points_.size()));
    }
    return result;
  }

  const std::string& file_;
  std::string_view text_;
  std::vector<vec3> points_;
  std::size_t columns_ = 0, fewest_ = 0, filename_ = no_column, x_ = no_column, y_ = no_column,
              level_ = no_column, weight_ = no_column;
  int line_ = 0;
  std::vector<Seen> seen_;
  std::map<std::string, std::size_t> place_of_;
};

}  // namespace

GridFile readVnlog(const std::string& file, std::string_view text, const BoardOfFiles& board) {
  return Vnlog(file, text, board).read();
}

}  // namespace slom::calibration
