/// Results as rows of a Markdown table.
#pragma once

#include "fit/comparison.hpp"

namespace slom::bench {

void printHeader();
void printRows(const Comparison& comparison, int threads);

}  // namespace slom::bench
