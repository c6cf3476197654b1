#include "support/table.hpp"

#include <iomanip>
#include <ostream>
#include <sstream>

#include "support/build_info.hpp"

namespace slom::bench {

namespace {

/// Returns the median time of the row relative to `variant` of the same measurement; 0 if there is none.
double ratioTo(const std::string& variant, const Row& row, const Table& table) {
  for (const Row& other : table.rows) {
    if (other.measurement == row.measurement && other.variant == variant) {
      return row.timing.median_ns / other.timing.median_ns;
    }
  }
  return 0;
}

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string ratioText(double ratio) { return ratio == 0 ? "-" : fixed(ratio, 2); }

std::string scientific(double value) {
  std::ostringstream text;
  text << std::scientific << std::setprecision(0) << value;
  return text.str();
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

}  // namespace

void writeMarkdown(std::ostream& out, const Table& table) {
  out << "| measurement | variant | ns per measurement | quartiles | / " << table.peer << " | / "
      << table.reference << " | deviation |\n|---|---|---:|---:|---:|---:|---:|\n";
  for (const Row& row : table.rows) {
    const Timing& t = row.timing;
    out << "| " << row.measurement << " | " << row.variant << " | " << fixed(t.median_ns, 1) << " | "
        << fixed(t.lower_ns, 1) << " - " << fixed(t.upper_ns, 1) << " | "
        << ratioText(ratioTo(table.peer, row, table)) << " | "
        << ratioText(ratioTo(table.reference, row, table)) << " | " << scientific(row.deviation) << " |\n";
  }
  out << "\nOne thread, median of " << table.repetitions << " repetitions in turn; " << processorName()
      << "; " << compilerName() << "; " << compileFlags() << " (" << instructionSet() << ").\n";
}

void writeJson(std::ostream& out, const Table& table) {
  out << "{\n  \"processor\": " << quoted(processorName()) << ",\n  \"compiler\": " << quoted(compilerName())
      << ",\n  \"flags\": " << quoted(compileFlags()) << ",\n  \"instructions\": " << quoted(instructionSet())
      << ",\n  \"threads\": 1,\n  \"repetitions\": " << table.repetitions << ",\n  \"results\": [";
  const char* separator = "\n";
  for (const Row& row : table.rows) {
    const Timing& t = row.timing;
    const double to_peer = ratioTo(table.peer, row, table);
    out << separator << "    {\"measurement\": " << quoted(row.measurement)
        << ", \"variant\": " << quoted(row.variant) << ", \"median_ns\": " << t.median_ns
        << ", \"lower_quartile_ns\": " << t.lower_ns << ", \"upper_quartile_ns\": " << t.upper_ns
        << ", \"ratio_to_peer\": ";
    if (to_peer == 0) {
      out << "null";
    } else {
      out << to_peer;
    }
    out << ", \"ratio_to_reference\": " << ratioTo(table.reference, row, table)
        << ", \"deviation\": " << row.deviation << "}";
    separator = ",\n";
  }
  out << "\n  ]\n}\n";
}

}  // namespace slom::bench
