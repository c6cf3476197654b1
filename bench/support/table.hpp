/// Results as a Markdown table and as JSON.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "support/variants.hpp"

namespace slom::bench {

struct Row {
  std::string measurement, variant;
  double deviation = 0;  ///< from the reference
  Timing timing;
};

struct Table {
  std::string reference, peer;  ///< the variants that times are compared with
  int repetitions = 0;
  std::vector<Row> rows;
};

/// Writes a line for each row. A ratio to a missing variant is `-`.
void writeMarkdown(std::ostream& out, const Table& table);
void writeJson(std::ostream& out, const Table& table);

}  // namespace slom::bench
