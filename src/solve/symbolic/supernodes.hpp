/// Structure of the factor, before any number is known: the fronts of a multifrontal Cholesky factorisation on the
/// graph of blocks.
///
/// A front eliminates the blocks of its `columns`. Its `rows` are the later blocks that this changes. It needs the
/// updates of its children and passes its own update to its parent. Blocks are renumbered by their position in the
/// order of elimination. In this order, each front's columns are contiguous and children come before parents.
///   source   Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", 1983;
///            Liu, "The role of elimination trees in sparse factorization", 1990;
///            Ashcraft and Grimes, "The influence of relaxed supernode partitions on the multifrontal method", 1989
#pragma once

#include <vector>

#include "graph.hpp"

namespace slom {

struct Front {
  int first_column = 0, last_column = 0;  ///< positions [first, last)
  int first_row = 0, last_row = 0;        ///< in Fronts::row
  int p = 0;                              ///< pivots: degrees of freedom of the columns
  int u = 0;                              ///< degrees of freedom of the rows
  int parent = -1;
};

struct Fronts {
  std::vector<int> order;     ///< block at each position
  std::vector<int> position;  ///< position of each block
  std::vector<int> offset;    ///< first unknown of each position in the permuted system; one more for the end
  std::vector<Front> front;   ///< children before parents
  std::vector<int> row;       ///< positions, ascending for each front
  double flops = 0;           ///< additions and multiplications of one factorisation
  const char* ordering = "given";
};

/// Returns the multiplications of a dense factorisation of p pivots and of its subtractions from u further rows.
inline double frontFlops(double p, double u) { return p * p * p / 3 + p * p * u + p * u * u; }

/// Makes the fronts. `order`: the blocks in a fill-reducing order, which is refined so that fronts are contiguous.
Fronts makeFronts(const BlockGraph& graph, const std::vector<int>& order);

}  // namespace slom
