#include "calibration/files/csv.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/files/text.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
namespace {

/// Returns the separator of a table with this header: a comma if the header has one, otherwise a semicolon or a tab.
/// Returns a comma if there is none.
char separatorOf(std::string_view header) {
  for (const char separator : {',', ';', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

/// Appends the fields of a line. Returns the number of fields.
std::size_t split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  const std::size_t before = fields.size();
  std::size_t begin = 0;
  for (std::size_t end; (end = line.find(separator, begin)) != std::string_view::npos; begin = end + 1) {
    fields.push_back(trimmed(line.substr(begin, end - begin)));
  }
  fields.push_back(trimmed(line.substr(begin)));
  return fields.size() - before;
}

/// The rest of a text, and the number of the line read last.
struct Lines {
  std::string_view rest;
  int line = 0;

  /// Reads the next line that is neither blank nor a comment. Returns false at the end.
  bool next(std::string_view& text, std::vector<CsvComment>& comments) {
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
      const bool is_pair = rest.substr(end).starts_with("\r\n");  // the line end of Windows
      text = rest.substr(0, end);
      rest.remove_prefix(std::min(end + (is_pair ? 2 : 1), rest.size()));
      if (++line == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
      text = trimmed(text);
      if (text.starts_with('#')) {
        comments.push_back({std::string(trimmed(text.substr(1))), line});
      } else if (!text.empty()) {
        return true;
      }
    }
    return false;
  }
};

constexpr std::size_t longest_text = 80;  // in a message; a file that is not a table may have very long lines

/// Recognises photographs by their first bytes: JPEG, PNG, TIFF of either byte order, BMP, or PGM and PPM with binary
/// numbers.
bool isPhotograph(std::string_view text) {
  constexpr std::string_view beginnings[] = {"\xFF\xD8\xFF", "\x89PNG", std::string_view("II*\0", 4),
                                             std::string_view("MM\0*", 4)};
  if (std::any_of(std::begin(beginnings), std::end(beginnings),
                  [&](std::string_view beginning) { return text.starts_with(beginning); }))
    return true;
  return (text.starts_with("BM") || text.starts_with("P5") || text.starts_with("P6")) &&
         text.substr(0, 1024).find_first_of(std::string_view("\0\xFF", 2)) != std::string_view::npos;
}

}  // namespace

CsvRow::CsvRow(const std::string& file, const std::vector<std::string>& columns, int line,
               std::size_t first_field, const std::vector<std::string_view>& fields)
    : file_(&file), columns_(&columns), fields_(&fields), first_field_(first_field), line_(line) {}

std::string CsvRow::place() const { return fmt::format("{}:{}", *file_, line_); }

void CsvRow::fail(std::size_t column, const std::string& expectation) const {
  badFile(fmt::format("{}: {} is \"{}\"; {}", place(), columns_->at(column),
                      shortened((*fields_)[first_field_ + column], longest_text), expectation));
}

double CsvRow::number(std::size_t column) const {
  double value = 0;
  std::string text(fields_->at(first_field_ + column));
  if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';  // 1,5; 2,5
  if (!io::parseNumber(std::string_view(text), value))
    fail(column, "write a number there, or remove the row");
  if (!std::isfinite(value)) fail(column, "write a finite number there, or remove the row");
  return value;
}

double CsvRow::number(std::size_t column, double most) const {
  const double value = number(column);
  if (!(std::abs(value) <= most))
    fail(column, fmt::format("write a number from {:g} to {:g} there, or remove the row", -most, most));
  return value;
}

int CsvRow::index(std::size_t column) const {
  int value = 0;
  if (!io::parseNumber(fields_->at(first_field_ + column), value) || value < 0)
    fail(column, "write a whole number (0, 1, 2, ...) there");
  return value;
}

std::string CsvRow::digits(std::size_t column) const {
  const std::string_view text = fields_->at(first_field_ + column);
  constexpr std::size_t most = 30;
  const bool are_digits = !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  if (!are_digits || text.size() > most) return std::to_string(index(column));
  return std::string(text.substr(std::min(text.find_first_not_of('0'), text.size() - 1)));
}

std::string CsvRow::nanoseconds(std::size_t column, TimeUnit unit) const {
  if (unit == TimeUnit::ns) return digits(column);
  const std::optional<std::int64_t> time = nanosecondsIn(fields_->at(first_field_ + column), unit);
  if (time && *time >= 0) return std::to_string(*time);
  fail(column, unit == TimeUnit::s    ? "write seconds there, as in 1403715273.262143"
               : unit == TimeUnit::ms ? "write milliseconds there, as in 1403715273262.143"
                                      : "write microseconds there, as in 1403715273262143");
}

std::vector<std::string> columnsOf(std::string_view text) {
  std::vector<CsvComment> comments;
  Lines lines{text};
  std::string_view header;
  std::vector<std::string_view> names;
  if (lines.next(header, comments)) split(header, separatorOf(header), names);
  return {names.begin(), names.end()};
}

CsvTable::CsvTable(std::string file, std::string text_of_file, std::vector<std::string> columns)
    : file_(std::move(file)), columns_(std::move(columns)), text_(std::move(text_of_file)) {
  const std::string header = fmt::format("{}", fmt::join(columns_, ","));
  if (isPhotograph(text_)) {
    badFile(fmt::format(
        "{}: this is a photograph instead of a table with the header \"{}\"; slom calibrate takes "
        "photographs by --images",
        file_, header));
  }
  Lines lines{text_};
  std::string_view text;
  if (!lines.next(text, comments_)) {
    if (!file_.ends_with(".csv") && !file_.ends_with(".tsv") && !file_.ends_with(".txt"))
      badFile(fmt::format("{}:1: the file is empty; write it again, or leave it out", file_));
    badFile(
        fmt::format("{}:1: the file is empty; its first line must be \"{}\", with one row for each "
                    "measurement below",
                    file_, header));
  }
  const char separator = separatorOf(text);
  split(text, separator, fields_);
  if (!std::equal(fields_.begin(), fields_.end(), columns_.begin(), columns_.end())) {
    badFile(fmt::format("{}:{}: the header is \"{}\"; it must be \"{}\"", file_, lines.line,
                        shortened(text, longest_text), header));
  }
  while (lines.next(text, comments_)) {
    const std::size_t first = fields_.size(), count = split(text, separator, fields_);
    if (count != columns_.size()) {
      badFile(fmt::format("{}:{}: the row has {} field{} instead of {}; write \"{}\"", file_, lines.line,
                          count, count == 1 ? "" : "s", columns_.size(), header));
    }
    rows_.emplace_back(file_, columns_, lines.line, first, fields_);
  }
  if (rows_.empty()) {
    badFile(fmt::format("{}:{}: there is nothing below the header; add one row for each measurement", file_,
                        lines.line));
  }
}

}  // namespace slom::calibration
