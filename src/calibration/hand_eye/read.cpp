// Streams of poses from files.
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/files/text.hpp"
#include "calibration/files/times.hpp"
#include "calibration/median.hpp"
#include "slom/calibration/hand_eye.hpp"
#include "slom/io/input_file.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
namespace {

constexpr const char* header_text = "t_s,x_m,y_m,z_m,qx,qy,qz,qw";
constexpr double most_m = 1e7;              // beyond, a coordinate is a mistake
constexpr double most_length_error = 0.05;  // of a quaternion that was rounded

namespace pose {
enum Column { time, x, y, z, qx, qy, qz, qw };
}
constexpr std::size_t column_count = 8;

/// A name of a column in a header.
struct ColumnName {
  std::string_view name;
  pose::Column column;
};
constexpr ColumnName column_names[] = {
    {"t", pose::time}, {"time", pose::time}, {"timestamp", pose::time}, {"x_m", pose::x},
    {"x", pose::x},    {"tx", pose::x},      {"p_x", pose::x},          {"y_m", pose::y},
    {"y", pose::y},    {"ty", pose::y},      {"p_y", pose::y},          {"z_m", pose::z},
    {"z", pose::z},    {"tz", pose::z},      {"p_z", pose::z},          {"qx", pose::qx},
    {"q_x", pose::qx}, {"qy", pose::qy},     {"q_y", pose::qy},         {"qz", pose::qz},
    {"q_z", pose::qz}, {"qw", pose::qw},     {"q_w", pose::qw}};

/// Returns what a column has; a time may also have a unit in its name.
std::optional<pose::Column> columnOf(std::string_view name) {
  for (const ColumnName& known : column_names) {
    if (known.name == name) return known.column;
  }
  return timeUnitIn(name) ? std::optional(pose::time) : std::nullopt;
}

/// The separators of a table: a character, or blanks of any number if it is a blank.
char fieldSeparator(std::string_view line) {
  for (const char separator : {',', ';'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = separator == ' ' ? line.find_first_of(" \t") : line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = trimmed(line);
  }
}

/// Where the columns are in a row; nothing: there is no such column.
struct Layout {
  std::array<std::optional<std::size_t>, column_count> index{};
  std::vector<std::string> names;  ///< of all columns of the file
  TimeUnit unit = TimeUnit::s;
  bool has_unit = false;  ///< the header states it
  char separator = ' ';
};

Layout layoutOfTum() {
  Layout layout;
  for (std::size_t c = 0; c < column_count; ++c) layout.index[c] = c;
  layout.names = {"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
  return layout;
}

Layout layoutOf(std::string_view header, const std::string& place) {
  Layout layout;
  layout.separator = fieldSeparator(header);
  for (const std::string_view field : split(header, layout.separator)) {
    if (const std::optional<pose::Column> column = columnOf(field)) {
      if (layout.index[*column])
        badFile(fmt::format("{}: {} and {} name the same column; keep one of them", place,
                            layout.names[*layout.index[*column]], field));
      layout.index[*column] = layout.names.size();
      if (*column == pose::time) {
        layout.has_unit = timeUnitIn(field).has_value();
        layout.unit = timeUnitIn(field).value_or(TimeUnit::s);
      }
    }
    layout.names.emplace_back(field);
  }
  for (const ColumnName& known : column_names) {
    if (known.column != pose::time && !layout.index[known.column])
      badFile(fmt::format("{}: the header is \"{}\" and lacks the column {}; write \"{}\"", place,
                          shortened(header, longest_quote), known.name, header_text));
  }
  return layout;
}

/// Reads rows of one layout.
class Rows {
 public:
  Rows(const std::string& file, const Layout& layout) : file_(file), layout_(layout) {}

  StampedPose read(std::string_view text, int line) const {
    const std::vector<std::string_view> fields = split(text, layout_.separator);
    if (fields.size() != layout_.names.size())
      badFile(fmt::format("{}:{}: the row has {} field{} instead of {}; write \"{}\"", file_, line,
                          fields.size(), fields.size() == 1 ? "" : "s", layout_.names.size(),
                          fmt::join(layout_.names, layout_.separator == ' ' ? " " : ",")));
    std::array<double, column_count> value{};
    for (std::size_t c = 0; c < column_count; ++c) {
      if (layout_.index[c]) value[c] = number(fields[*layout_.index[c]], c, line);
    }
    return {value[pose::time],
            SE3(rotation(value, line), vec3(value[pose::x], value[pose::y], value[pose::z])), line};
  }

 private:
  double number(std::string_view text, std::size_t column, int line) const {
    double value = 0;
    if (column == pose::time && layout_.unit != TimeUnit::s) {
      if (const auto ns = nanosecondsIn(text, layout_.unit)) return double(*ns) * 1e-9;
    }
    const char* wanted = nullptr;
    if (!io::parseNumber(text, value)) {
      wanted = "a number";
    } else if (!std::isfinite(value)) {
      wanted = "a finite number";
    } else if (column >= pose::x && column <= pose::z && std::abs(value) > most_m) {
      wanted = "metres, at most 1e7,";
    }
    if (wanted)
      badFile(fmt::format("{}:{}: {} is \"{}\"; write {} there, or remove the row", file_, line,
                          layout_.names[*layout_.index[column]], shortened(text, longest_quote), wanted));
    return column == pose::time ? value * std::pow(10, int(layout_.unit) - int(TimeUnit::s)) : value;
  }

  SO3 rotation(const std::array<double, column_count>& value, int line) const {
    const double length = std::sqrt(value[pose::qx] * value[pose::qx] + value[pose::qy] * value[pose::qy] +
                                    value[pose::qz] * value[pose::qz] + value[pose::qw] * value[pose::qw]);
    if (!(std::abs(length - 1) <= most_length_error))
      badFile(fmt::format(
          "{}:{}: the quaternion has the length {:.6g} instead of 1; correct it, or remove the row", file_,
          line, length));
    return {value[pose::qw], value[pose::qx], value[pose::qy], value[pose::qz]};
  }

  const std::string& file_;
  const Layout& layout_;
};

/// Refuses times taken as seconds, with no unit in the header, whose intervals are usual in a smaller unit.
void requireIntervalsOfSeconds(const PoseStream& stream) {
  constexpr double longest = 1000, least = 1e-4, most = 10;  // s
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stream.poses.size(); ++i)
    intervals.push_back(stream.poses[i].t_s - stream.poses[i - 1].t_s);
  const double median = medianOf(std::move(intervals));
  if (!(median > longest)) return;
  for (const auto& [factor, unit, name] : {std::tuple(1e-9, "nanoseconds", "t_ns"),
                                           {1e-6, "microseconds", "t_us"},
                                           {1e-3, "milliseconds", "t_ms"}}) {
    if (!(factor * median > least && factor * median < most)) continue;
    badFile(fmt::format(
        "{}: poses follow each other by {:.3g} s if their times are seconds, as if they were {}; name their column {} in a "
        "header",
        stream.file, median, unit, name));
  }
}

bool beginsWithNumber(std::string_view line) {
  double number = 0;
  return io::parseNumber(split(line, fieldSeparator(line)).front(), number);
}

/// Returns the layout that the first line states, and whether that line is a header.
std::pair<Layout, bool> layoutAt(std::string_view line, const std::string& place) {
  if (!beginsWithNumber(line)) return {layoutOf(line, place), true};
  if (fieldSeparator(line) == ' ' && split(line, ' ').size() == column_count) return {layoutOfTum(), false};
  badFile(fmt::format(
      "{}: there is no header, and numbers alone do not say what they are; put \"{}\" above, or write "
      "a trajectory of TUM (t x y z qx qy qz qw, separated by blanks)",
      place, header_text));
}

}  // namespace

std::string PoseStream::place(std::size_t index) const {
  const int line = poses[index].line;
  return line > 0 ? fmt::format("{}:{}", file, line)
                  : fmt::format("{}: pose {}", file.empty() ? "stream" : file, index);
}

PoseStream readPoseStream(const std::string& file) {
  const std::string text = io::readWhole(file);
  PoseStream stream{.file = file, .poses = {}};
  std::optional<Layout> layout;
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view row = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (row.empty() || row.starts_with('#')) continue;
    if (!layout) {
      auto [found, is_header] = layoutAt(row, fmt::format("{}:{}", file, line));
      layout = std::move(found);
      stream.has_times = layout->index[pose::time].has_value();
      if (is_header) continue;
    }
    stream.poses.push_back(Rows(file, *layout).read(row, line));
    if (!stream.has_times) stream.poses.back().t_s = double(stream.poses.size() - 1);
  }
  if (stream.poses.empty())
    badFile(fmt::format("{}: there are no poses; write \"{}\" and one row for each pose", file, header_text));
  if (stream.has_times && !layout->has_unit) requireIntervalsOfSeconds(stream);
  return stream;
}

}  // namespace slom::calibration
