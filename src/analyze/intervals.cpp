#include "slom/analyze/intervals.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "base/classic_numbers.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

using Cells = std::array<std::string, 5>;  // name, value, standard deviation, lower, upper

/// Writes x with the decimals that a hundredth of the standard deviation needs.
std::string decimal(double x, double standard_deviation) {
  const double decimals = 1 - std::floor(std::log10(standard_deviation)) + 1;
  if (!std::isfinite(x) || !(std::abs(x) < 1e9) || !(decimals >= 0 && decimals <= 12)) return number(x, 6);
  const ClassicNumbers points;
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f", static_cast<int>(decimals), x);
  return text.data();
}

Cells cellsOf(const ParameterInterval& row) {
  const bool is_at_bound = row.standard_deviation == 0 && row.lower < row.upper;
  const double s = is_at_bound ? (row.upper - row.lower) / 4 : row.standard_deviation;
  return {row.name + (row.is_profile ? "" : " *"), decimal(row.value, s),
          is_at_bound ? "at bound" : number(s, 3), decimal(row.lower, s), decimal(row.upper, s)};
}

std::vector<Cells> cellsOf(const IntervalTable& table) {
  std::vector<Cells> rows{{"parameter", "value", "standard deviation", "lower", "upper"}};
  for (const ParameterInterval& row : table.rows) rows.push_back(cellsOf(row));
  return rows;
}

bool isAnyByDeviation(const IntervalTable& table) {
  return std::ranges::any_of(table.rows, [](const auto& row) { return !row.is_profile; });
}

constexpr const char* kByDeviation = "from the standard deviation; all others by profile likelihood";

std::string allDigits(double x) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x).ptr};
}

/// Quotes a CSV field by RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("|\\`*_<").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

}  // namespace

std::string IntervalTable::text() const {
  const std::vector<Cells> cells = cellsOf(*this);
  std::array<std::size_t, 5> width{};
  for (const Cells& row : cells) {
    for (std::size_t c = 0; c < width.size(); ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string all = number(100 * probability, 6) + " % intervals\n";
  for (const Cells& row : cells) {
    all += "  " + row[0] + std::string(width[0] - row[0].size(), ' ');
    for (std::size_t c = 1; c < width.size(); ++c)
      all += "  " + std::string(width[c] - row[c].size(), ' ') + row[c];
    all += "\n";
  }
  if (isAnyByDeviation(*this)) all += std::string("  * ") + kByDeviation + "\n";
  return all;
}

std::string IntervalTable::markdown() const {
  std::string all = "| parameter | value | standard deviation | " + number(100 * probability, 6) +
                    " % from | to |\n| --- | ---: | ---: | ---: | ---: |\n";
  for (const ParameterInterval& row : rows) {
    const Cells cells = cellsOf(row);
    all += "| " + escaped(cells[0]);
    for (std::size_t c = 1; c < cells.size(); ++c) all += " | " + cells[c];
    all += " |\n";
  }
  if (isAnyByDeviation(*this)) all += std::string("\n\\* ") + kByDeviation + "\n";
  return all;
}

std::string IntervalTable::csv() const {
  std::string all = "parameter,value,standard_deviation,lower,upper,method\n";
  for (const ParameterInterval& row : rows) {
    all += quoted(row.name);
    for (const double x : {row.value, row.standard_deviation, row.lower, row.upper})
      (all += ",") += allDigits(x);
    all += row.is_profile ? ",profile\n" : ",standard deviation\n";
  }
  return all;
}

std::ostream& operator<<(std::ostream& os, const IntervalTable& table) { return os << table.text(); }

}  // namespace slom
