/// The shape of the linear system: blocks of unknowns (one for each optimised variable) and who meets whom.
#pragma once

#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// A batch of measurements of one pool as the solver sees it: which blocks each one touches.
struct MeasurementGroup {
  int arity = 0;
  std::vector<int>
      blocks;  ///< size() x arity; -1 for a fixed variable. The same block may occur twice in a row.
  int size() const { return arity == 0 ? 0 : static_cast<int>(blocks.size()) / arity; }
};

struct BlockStructure {
  std::vector<int> offset;  ///< block b holds the unknowns offset[b] .. offset[b + 1] - 1
  std::vector<MeasurementGroup> groups;

  int blockCount() const { return static_cast<int>(offset.size()) - 1; }
  int unknowns() const { return offset.back(); }
  int dof(int block) const {
    return offset[static_cast<std::size_t>(block) + 1] - offset[static_cast<std::size_t>(block)];
  }
};

/// The structure of a problem, and the way back from unknowns to variables. Components that are held keep their place among
/// the unknowns: their columns of J are 0, and a group behind those of the pools, with a "measurement" for each variable that
/// has such components, says that they do not move.
struct ProblemStructure {
  BlockStructure system;
  std::vector<int> variable_of_block;
  std::vector<int> block_of_variable;   ///< by table index; -1: fixed or free row of the table
  std::vector<int> offset_of_variable;  ///< likewise, first unknown
  int residuals = 0;                    ///< sum of the lengths of all residuals
};

ProblemStructure makeStructure(const Problem& problem);

}  // namespace slom
