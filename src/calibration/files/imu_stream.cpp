// Streams of an IMU: tables of times and readings, and Kalibr's description of their noise.
#include "slom/calibration/imu_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calibration/files/document.hpp"
#include "calibration/files/text.hpp"
#include "slom/io/input_file.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t columns = 7;
constexpr const char* row_text = "time, 3 angular velocities [rad/s], 3 specific forces [m/s^2]";

/// A row that is no header and no comment.
struct Row {
  int line = 0;
  std::string_view fields[columns];
};

/// A table with any header. Fields are separated by commas, semicolons, tabs or blanks.
struct Table {
  const std::string& file;
  std::string header;  ///< all lines before the first row
  std::vector<Row> rows;

  Table(const std::string& name, std::string_view text) : file(name) {
    int line = 0;
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      add(trimmed(text.substr(0, end)), ++line);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (rows.empty())
      badFile(fmt::format("{}: the file has no readings; write a row for each, with {}", file, row_text));
  }

  [[noreturn]] void fail(int line, const std::string& sentence) const {
    badFile(fmt::format("{}:{}: {}", file, line, sentence));
  }

 private:
  void add(std::string_view text, int line) {
    if (text.empty()) return;
    const bool is_word = text.front() == '#' ||
                         (rows.empty() && (std::isalpha(static_cast<unsigned char>(text.front())) != 0 ||
                                           text.front() == '"'));
    if (is_word) {
      if (rows.empty()) header.append(text).push_back('\n');
      return;
    }
    Row row{line, {}};
    std::size_t count = 0;
    constexpr std::string_view separators = ",; \t";
    while (!text.empty()) {
      const std::size_t end = std::min(text.find_first_of(separators), text.size());
      if (count < columns) row.fields[count] = text.substr(0, end);
      ++count;
      text = trimmed(text.substr(end));
      if (!text.empty() && (text.front() == ',' || text.front() == ';')) text = trimmed(text.substr(1));
    }
    if (count != columns)
      fail(line, fmt::format("the row has {} field{} instead of {}; write {}", count, count == 1 ? "" : "s",
                             columns, row_text));
    rows.push_back(row);
  }
};

/// Returns whether the times are seconds: the header says so, or a time has a decimal point.
bool areSeconds(const Table& table) {
  if (table.header.find("t_s,") != std::string::npos || table.header.find("[s]") != std::string::npos)
    return true;
  return std::any_of(table.rows.begin(), table.rows.end(), [](const Row& row) {
    return row.fields[0].find_first_of(".eE") != std::string_view::npos;
  });
}

/// Reads a time exactly [ns].
std::int64_t timeOf(const Table& table, const Row& row, bool are_seconds) {
  const std::string_view text = row.fields[0];
  std::int64_t time = 0;
  if (!are_seconds) {
    if (!io::parseNumber(text, time))
      table.fail(row.line,
                 fmt::format("the time is \"{}\"; write whole nanoseconds, or seconds with a decimal point",
                             shortened(text, longest_quote)));
    return time;
  }
  const std::size_t point = std::min(text.find('.'), text.size());
  constexpr std::int64_t second = 1'000'000'000;
  const std::string_view whole = text.substr(0, point), rest = text.substr(std::min(point + 1, text.size()));
  const bool is_plain = rest.find_first_not_of("0123456789") == std::string_view::npos &&
                        io::parseNumber(whole, time) &&
                        std::abs(time) < std::numeric_limits<std::int64_t>::max() / second;
  if (is_plain) {
    std::string places(rest.substr(0, 9));
    places.resize(9, '0');
    std::int64_t part = 0;
    io::parseNumber(std::string_view(places), part);
    return time * second + (text.starts_with('-') ? -part : part);
  }
  double seconds = 0;
  if (!io::parseNumber(text, seconds) || !(std::abs(seconds) < 9e9))
    table.fail(row.line, fmt::format("the time is \"{}\"; write seconds", shortened(text, longest_quote)));
  return std::int64_t(std::llround(seconds * 1e9));
}

double readingOf(const Table& table, const Row& row, std::size_t column) {
  double value = 0;
  if (io::parseNumber(row.fields[column], value) && std::abs(value) <= most_reading_m_s2) return value;
  table.fail(row.line, fmt::format("column {} is \"{}\"; write a number from {:g} to {:g}, or remove the row",
                                   column + 1, shortened(row.fields[column], longest_quote),
                                   -most_reading_m_s2, most_reading_m_s2));
}

}  // namespace

ImuStream readImuStream(const std::string& name, const std::string& file) {
  const std::string text = io::readWhole(file);
  const Table table(file, text);
  const bool are_seconds = areSeconds(table);
  ImuStream imu;
  imu.name = name;
  imu.file = file;
  imu.samples.reserve(table.rows.size());
  std::int64_t before = 0;
  for (const Row& row : table.rows) {
    const std::int64_t time = timeOf(table, row, are_seconds);
    if (imu.samples.empty()) imu.epoch_ns = time;
    if (!imu.samples.empty() && time <= before) {
      table.fail(
          row.line,
          time == before
              ? fmt::format("the time {} is that of the row before; remove one of the two", row.fields[0])
              : fmt::format("the time {} is {:.6g} s before that of the row before; sort the rows by time",
                            row.fields[0], double(before - time) * 1e-9));
    }
    before = time;
    const auto read = [&](std::size_t column) { return readingOf(table, row, column); };
    imu.samples.push_back({double(time - imu.epoch_ns) * 1e-9, vec3(read(1), read(2), read(3)),
                           vec3(read(4), read(5), read(6))});
  }
  if (imu.samples.size() < 2) badFile(fmt::format("{}: there is only one reading; give a recording", file));
  return imu;
}

ImuNoise readImuNoise(const std::string& file) {
  Document document(file, io::readWhole(file));
  parseYaml(document);
  const auto density = [&](std::string_view key) {
    const Node* node = document.root.kind == Node::Kind::map ? document.root.find(key) : nullptr;
    if (!node && document.root.kind == Node::Kind::map) {  // Kalibr's imu chain: imu0: ...
      if (const Node* const first = document.root.find("imu0")) node = first->find(key);
    }
    if (!node) document.fail(document.root.line, fmt::format("there is no {}; give Kalibr's imu.yaml", key));
    const double value = document.number(*node, key, 1e3);
    if (!(value > 0))
      document.fail(node->line, fmt::format("{} is {:g}; write a positive number", key, value));
    return value;
  };
  return {density("gyroscope_noise_density"), density("accelerometer_noise_density"),
          density("gyroscope_random_walk"), density("accelerometer_random_walk")};
}

}  // namespace slom::calibration
