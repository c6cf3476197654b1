#include "calibration/files/grid_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>

#include "calibration/files/text.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns the first line with content: not blank, and no comment unless the comment holds column names.
std::string_view firstLine(std::string_view text, bool with_comments) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const bool is_comment =
        line.starts_with('#') && (!with_comments || line.starts_with("##") || line.starts_with("#!"));
    if (!line.empty() && !is_comment) return line;
  }
  return {};
}

bool hasWord(std::string_view line, std::string_view word) {
  for (std::size_t at = line.find(word); at != std::string_view::npos; at = line.find(word, at + 1)) {
    const auto isEdge = [&](std::size_t i) {
      return i >= line.size() || line[i] == ' ' || line[i] == '\t' || line[i] == '#';
    };
    if ((at == 0 || isEdge(at - 1)) && isEdge(at + word.size())) return true;
  }
  return false;
}

/// Recognises a line such as `image_points:`, a key of YAML without the line %YAML.
bool beginsWithKey(std::string_view line) {
  const std::size_t end = std::min(line.find(':'), line.size());
  return end > 0 && end < line.size() && (end + 1 == line.size() || line[end + 1] == ' ') &&
         std::all_of(line.begin(), line.begin() + std::ptrdiff_t(end),
                     [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; });
}

/// Returns the runs of digits in a file's name, without leading zeros.
std::vector<std::string> runsOfDigits(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem();
  std::vector<std::string> runs;
  for (std::size_t i = 0; i < stem.size();) {
    const std::size_t begin = i;
    while (i < stem.size() && std::isdigit(static_cast<unsigned char>(stem[i]))) ++i;
    if (i == begin) {
      ++i;
      continue;
    }
    const std::string run = stem.substr(begin, i - begin);
    runs.push_back(run.substr(std::min(run.find_first_not_of('0'), run.size() - 1)));
  }
  return runs;
}

/// Returns two images with the same number in run `from_end`, counted from the end of the name; nothing if all
/// differ.
std::optional<std::pair<std::size_t, std::size_t>> sameNumber(
    const std::vector<std::vector<std::string>>& runs, std::size_t from_end) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto [known, is_new] = first.emplace(runs[i][runs[i].size() - 1 - from_end], i);
    if (!is_new) return std::pair(known->second, i);
  }
  return {};
}

/// Returns the run, counted from the end of the name, that has the most different numbers.
std::size_t mostDistinct(const std::vector<std::vector<std::string>>& runs, std::size_t places) {
  std::size_t best = 0, most = 0;
  for (std::size_t from_end = 0; from_end < places; ++from_end) {
    std::set<std::string> numbers;
    for (const auto& of_name : runs) numbers.insert(of_name[of_name.size() - 1 - from_end]);
    if (numbers.size() > most) most = numbers.size(), best = from_end;
  }
  return best;
}

}  // namespace

FileFormat formatOf(std::string_view text) {
  const std::string_view first = firstLine(text, true);
  if (first.starts_with('#') && hasWord(first, "filename") && hasWord(first, "x") && hasWord(first, "y"))
    return FileFormat::vnlog;
  const std::string_view words = firstLine(text, false);
  if (words.starts_with('<')) return FileFormat::xml;
  if (words.starts_with("%YAML") || words.starts_with("---") || words.starts_with('{') ||
      beginsWithKey(words))
    return FileFormat::yaml;
  return FileFormat::table;
}

std::vector<vec3> pointsOf(const BoardOfFiles& board, const std::string& file) {
  if (!board.points.empty()) return board.points;
  const bool has_size = board.columns > 0 && board.rows > 0;
  if (!has_size || !(board.square_m > 0)) {
    const std::string missing = has_size ? "how long a square is"
                                : board.square_m > 0
                                    ? "how many corners the board has in a row"
                                    : "how many corners the board has in a row, and how long a square is";
    throw DataError("slom.calibration.no-board",
                    {.place = file,
                     .fault = "the file does not say " + missing,
                     .remedy = "state the columns, rows and side of a square in BoardOfFiles"});
  }
  std::vector<vec3> points;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column)
      points.emplace_back(board.square_m * column, board.square_m * row, 0.);
  }
  return points;
}

void numberByNames(const std::string& file, std::vector<GridImage>& images) {
  std::vector<std::vector<std::string>> runs;
  std::size_t fewest = std::string::npos;
  for (const GridImage& image : images) {
    runs.push_back(runsOfDigits(image.name));
    fewest = std::min(fewest, runs.back().size());
    if (fewest > 0) continue;
    badFile(
        fmt::format("{}: the name of image {} has no number to pair images taken at the same time; rename "
                    "it, as in left07.jpg",
                    file, shortened(image.name, longest_quote)));
  }
  for (std::size_t from_end = 0; from_end < fewest; ++from_end) {
    if (sameNumber(runs, from_end)) continue;
    for (std::size_t i = 0; i < images.size(); ++i) images[i].digits = runs[i][runs[i].size() - 1 - from_end];
    return;
  }
  const auto [a, b] = *sameNumber(runs, mostDistinct(runs, fewest));
  badFile(fmt::format(
      "{}: images {} and {} have the same number in their names; put the images of each camera into a "
      "file of its own, and give each image a number of its own",
      file, shortened(images[a].name, longest_quote), shortened(images[b].name, longest_quote)));
}

}  // namespace slom::calibration
