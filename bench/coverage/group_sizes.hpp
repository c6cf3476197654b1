/// Coverage of clustered 95 % intervals over sizes and numbers of groups.
#pragma once

namespace slom::bench {

/// Prints a section of docs/coverage.md.
void printGroupSizes(int runs);

}  // namespace slom::bench
