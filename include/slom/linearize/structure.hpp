/// The shape of the linear system: blocks of unknowns (one for each optimised variable) and who meets whom.
#pragma once

#include <span>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// A batch of measurements of one pool as the solver sees it: which blocks each one touches.
struct MeasurementGroup {
  int arity = 0;
  std::vector<int>
      blocks;  ///< size() x arity; -1 for a fixed variable. The same block may occur twice in a row.
  int size() const { return arity == 0 ? 0 : static_cast<int>(blocks.size()) / arity; }

  bool operator==(const MeasurementGroup&) const = default;
};

/// Blocks of unknowns and the groups of measurements that touch them: all that a solver knows of a problem.
struct BlockStructure {
  /// Block b holds the unknowns offset[b] .. offset[b + 1] - 1. A block without unknowns is empty: no measurement touches it.
  std::vector<int> offset;
  std::vector<MeasurementGroup> groups;

  /// The number of blocks, empty ones included.
  int blockCount() const { return static_cast<int>(offset.size()) - 1; }
  /// The number of unknowns: columns of J.
  int unknowns() const { return offset.back(); }
  /// The number of unknowns of a block.
  int dof(int block) const {
    return offset[static_cast<std::size_t>(block) + 1] - offset[static_cast<std::size_t>(block)];
  }
  /// Whether the block has no unknowns.
  bool isEmpty(int block) const { return dof(block) == 0; }
  /// Number of blocks that are not empty.
  int filledCount() const {
    int count = 0;
    for (int b = 0; b < blockCount(); ++b) count += isEmpty(b) ? 0 : 1;
    return count;
  }

  bool operator==(const BlockStructure&) const = default;
};

/// In what a structure differs from an earlier one.
struct StructureChanges {
  bool blocks = false;        ///< there may be other blocks, or blocks of another size
  bool meetings = false;      ///< other blocks may meet in measurements
  bool measurements = false;  ///< there may be other measurements, or empty blocks

  /// Whether anything differs.
  bool any() const { return blocks || meetings || measurements; }
  /// Takes further changes in.
  void add(const StructureChanges& more) {
    blocks = blocks || more.blocks;
    meetings = meetings || more.meetings;
    measurements = measurements || more.measurements;
  }
  /// As of a problem of which nothing is known.
  static StructureChanges all() { return {true, true, true}; }
};

/// The structure of a problem. A block has the index of its variable in the problem's table, for life; blocks of fixed and of removed
/// variables are empty. Components that are fixed or at an active bound keep their place among the unknowns: their columns of J are 0, and a group
/// after those of the pools, with a "measurement" for each variable that has fixed components or bounds, says which do not move.
struct ProblemStructure {
  BlockStructure system;
  int pools = 0;      ///< number of groups that are pools
  int residuals = 0;  ///< sum of the lengths of all residuals

  /// The first unknown of a variable.
  int offsetOf(int variable) const { return system.offset[static_cast<std::size_t>(variable)]; }
  bool operator==(const ProblemStructure&) const = default;
};

/// The structure of a problem, from scratch.
ProblemStructure makeStructure(const Problem& problem);

/// Brings the structure that the problem had before some changes up to date; says what has changed of it. Takes time in proportion to the
/// changes, and an addition for each block after the first one whose size has changed.
StructureChanges updateStructure(const Problem& problem, std::span<const Change> changes,
                                 ProblemStructure& structure);

}  // namespace slom
