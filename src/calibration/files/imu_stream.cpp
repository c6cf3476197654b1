// Streams of an IMU: tables of times and readings, and Kalibr's description of their noise.
#include "slom/calibration/imu_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/files/document.hpp"
#include "calibration/files/text.hpp"
#include "calibration/files/times.hpp"
#include "calibration/median.hpp"
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

/// Returns the unit of the times that a line of the header states in its first column.
std::optional<TimeUnit> unitInLine(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of("# \t\""), line.size()));
  std::size_t end = line.find_first_of(",;\t");
  if (end == std::string_view::npos) {
    end = line.find(' ');
    const std::string_view rest = end == std::string_view::npos ? "" : trimmed(line.substr(end));
    if (rest.starts_with('[') || rest.starts_with('(')) end = line.find(' ', line.find_first_of("[("));
  }
  return timeUnitIn(line.substr(0, end));
}

/// Returns the unit that the header states.
std::optional<TimeUnit> statedUnit(const Table& table) {
  for (std::string_view rest = table.header; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    if (const auto unit = unitInLine(rest.substr(0, end))) return unit;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

/// Returns the unit of times without a stated one: seconds if a time has a decimal point.
TimeUnit usualUnit(const Table& table) {
  const bool has_point = std::any_of(table.rows.begin(), table.rows.end(), [](const Row& row) {
    return row.fields[0].find_first_of(".eE") != std::string_view::npos;
  });
  return has_point ? TimeUnit::s : TimeUnit::ns;
}

/// Reads a time exactly [ns].
std::int64_t timeOf(const Table& table, const Row& row, TimeUnit unit) {
  if (const std::optional<std::int64_t> time = nanosecondsIn(row.fields[0], unit)) return *time;
  const char* const wanted = unit == TimeUnit::s    ? "seconds"
                             : unit == TimeUnit::ms ? "milliseconds"
                             : unit == TimeUnit::us ? "microseconds"
                                                    : "whole nanoseconds, or t_s in the header and seconds";
  table.fail(row.line,
             fmt::format("the time is \"{}\"; write {}", shortened(row.fields[0], longest_quote), wanted));
}

/// Refuses a row whose time is not after that of the row before, but `ns` before it.
[[noreturn]] void refuseOrder(const Table& table, const Row& row, std::int64_t ns) {
  const std::string_view time = row.fields[0], above = (&row - 1)->fields[0];
  if (ns > 0)
    table.fail(row.line,
               fmt::format("the time {} is {:.6g} s before that of the row before; sort the rows by time",
                           time, double(ns) * 1e-9));
  if (time != above)
    table.fail(row.line, fmt::format("the time {} is less than 1 ns after {}; correct the unit in the header",
                                     time, above));
  table.fail(row.line, fmt::format("the time {} is that of the row before; remove one of the two", time));
}

/// Refuses times in nanoseconds whose intervals no IMU has, but that would be usual in a larger unit.
void requireIntervalsOfAnImu(const ImuStream& imu) {
  constexpr double shortest = 2e-5, least = 1e-4, most = 1;  // s
  std::vector<double> intervals;
  for (std::size_t i = 1; i < imu.samples.size(); ++i)
    intervals.push_back(imu.samples[i].time - imu.samples[i - 1].time);
  const double median = medianOf(std::move(intervals));
  if (median > shortest) return;
  for (const auto& [factor, unit, name] :
       {std::tuple(1e3, "microseconds", "t_us"), {1e6, "milliseconds", "t_ms"}, {1e9, "seconds", "t_s"}}) {
    if (!(factor * median > least && factor * median < most)) continue;
    badFile(fmt::format(
        "{}: readings follow each other by {:.3g} s if their times are nanoseconds, as if they were {}; write {} in the "
        "header",
        imu.file, median, unit, name));
  }
}

double readingOf(const Table& table, const Row& row, std::size_t column) {
  double value = 0;
  if (io::parseNumber(row.fields[column], value) && std::abs(value) <= most_reading_m_s2) return value;
  table.fail(row.line, fmt::format("column {} is \"{}\"; write a number from {:g} to {:g}, or remove the row",
                                   column + 1, shortened(row.fields[column], longest_quote),
                                   -most_reading_m_s2, most_reading_m_s2));
}

}  // namespace

ImuStream readImuStream(const std::string& name, const std::string& path) {
  const std::string file = inFolder(path, "data.csv");
  const std::string text = io::readWhole(file);
  const Table table(file, text);
  const std::optional<TimeUnit> stated = statedUnit(table);
  const TimeUnit unit = stated.value_or(usualUnit(table));
  ImuStream imu;
  imu.name = name;
  imu.file = file;
  imu.samples.reserve(table.rows.size());
  std::int64_t before = 0;
  for (const Row& row : table.rows) {
    const std::int64_t time = timeOf(table, row, unit);
    if (imu.samples.empty()) imu.epoch_ns = time;
    if (!imu.samples.empty() && time <= before) refuseOrder(table, row, before - time);
    before = time;
    const auto read = [&](std::size_t column) { return readingOf(table, row, column); };
    imu.samples.push_back({double(time - imu.epoch_ns) * 1e-9, vec3(read(1), read(2), read(3)),
                           vec3(read(4), read(5), read(6))});
  }
  if (imu.samples.size() < 2) badFile(fmt::format("{}: there is only one reading; give a recording", file));
  if (!stated && unit == TimeUnit::ns) requireIntervalsOfAnImu(imu);
  return imu;
}

ImuNoise readImuNoise(const std::string& path) {
  const std::string file = inFolder(path, "sensor.yaml");
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
