#include "calibrate/input/csv.hpp"

#include <cerrno>
#include <cmath>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "error.hpp"
#include "input_file.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t begin = 0;
  for (std::size_t comma; (comma = line.find(',', begin)) != std::string::npos; begin = comma + 1) {
    fields.push_back(trimmed(std::string_view(line).substr(begin, comma - begin)));
  }
  fields.push_back(trimmed(std::string_view(line).substr(begin)));
  return fields;
}

std::ifstream open(const std::string& file) {
  errno = 0;
  std::ifstream stream(file);
  if (stream) stream.peek();  // a folder opens, and fails only when it is read
  if (!stream && !stream.eof()) cannotRead(file);
  stream.clear();
  return stream;
}

/// The next line that is neither blank nor a comment, or false at the end of the file.
bool nextLine(std::ifstream& stream, std::string& text, int& line, std::vector<CsvComment>& comments) {
  while (std::getline(stream, text)) {
    if (++line == 1 && text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    text = trimmed(text);
    if (text.starts_with('#')) {
      comments.push_back({trimmed(std::string_view(text).substr(1)), line});
    } else if (!text.empty()) {
      return true;
    }
  }
  return false;
}

constexpr std::size_t longest_text =
    80;  // in a message: a file that is no table may have lines of any length

}  // namespace

CsvRow::CsvRow(const std::string& file, const std::vector<std::string>& columns, int line,
               std::vector<std::string> fields)
    : file_(&file), columns_(&columns), line_(line), fields_(std::move(fields)) {}

std::string CsvRow::place() const { return fmt::format("{}:{}", *file_, line_); }

void CsvRow::fail(std::size_t column, const std::string& expectation) const {
  throw UserError(fmt::format("{}: {} is \"{}\"; {}", place(), columns_->at(column),
                              shortened(fields_[column], longest_text), expectation));
}

double CsvRow::number(std::size_t column) const {
  double value = 0;
  if (!parseNumber(fields_.at(column), value)) fail(column, "write a number there, or remove the row");
  if (!std::isfinite(value)) fail(column, "write a finite number there, or remove the row");
  return value;
}

int CsvRow::index(std::size_t column) const {
  int value = 0;
  if (!parseNumber(fields_.at(column), value) || value < 0)
    fail(column, "write a whole number (0, 1, 2, ...) there");
  return value;
}

CsvTable::CsvTable(std::string file, std::vector<std::string> columns)
    : file_(std::move(file)), columns_(std::move(columns)) {
  const std::string header = fmt::format("{}", fmt::join(columns_, ","));
  std::ifstream stream = open(file_);
  std::string text;
  int line = 0;
  if (!nextLine(stream, text, line, comments_)) {
    throw UserError(
        fmt::format("{}:1: the file is empty; its first line must be \"{}\", with one row for each "
                    "measurement below",
                    file_, header));
  }
  if (split(text) != columns_) {
    throw UserError(fmt::format("{}:{}: the header is \"{}\"; it must be \"{}\"", file_, line,
                                shortened(text, longest_text), header));
  }
  while (nextLine(stream, text, line, comments_)) {
    std::vector<std::string> fields = split(text);
    if (fields.size() != columns_.size()) {
      throw UserError(fmt::format("{}:{}: the row has {} field{} instead of {}; write \"{}\"", file_, line,
                                  fields.size(), fields.size() == 1 ? "" : "s", columns_.size(), header));
    }
    rows_.emplace_back(file_, columns_, line, std::move(fields));
  }
  if (rows_.empty()) {
    throw UserError(fmt::format("{}:{}: there is nothing below the header; add one row for each measurement",
                                file_, line));
  }
}

}  // namespace slom::app::calib
