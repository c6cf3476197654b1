/// Structure of the linear system: blocks of unknowns (one for each optimised variable), and which blocks meet in
/// measurements.
#pragma once

#include <span>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// The measurements of one pool for the solver: the blocks that each of them depends on.
struct MeasurementGroup {
  int arity = 0;
  /// size() x arity; -1 for a fixed variable. One measurement may contain a block twice.
  std::vector<int> blocks;
  int size() const { return arity == 0 ? 0 : static_cast<int>(blocks.size()) / arity; }

  bool operator==(const MeasurementGroup&) const = default;
};

/// Blocks of unknowns and the groups of measurements that depend on them. A solver sees nothing else of a problem.
struct BlockStructure {
  /// Block b has the unknowns offset[b] .. offset[b + 1] - 1. A block without unknowns is empty: no measurement depends
  /// on it.
  std::vector<int> offset;
  std::vector<MeasurementGroup> groups;

  /// Returns the number of blocks, including empty ones.
  int blockCount() const { return static_cast<int>(offset.size()) - 1; }
  /// Returns the number of unknowns: columns of J.
  int unknowns() const { return offset.back(); }
  /// Returns the number of unknowns of a block.
  int dof(int block) const {
    return offset[static_cast<std::size_t>(block) + 1] - offset[static_cast<std::size_t>(block)];
  }
  /// Returns whether the block has no unknowns.
  bool isEmpty(int block) const { return dof(block) == 0; }
  /// Returns the number of blocks that are not empty.
  int filledCount() const {
    int count = 0;
    for (int b = 0; b < blockCount(); ++b) count += isEmpty(b) ? 0 : 1;
    return count;
  }

  bool operator==(const BlockStructure&) const = default;
};

/// Differences between a structure and an earlier one.
struct StructureChanges {
  bool blocks = false;        ///< the blocks or their sizes may differ
  bool meetings = false;      ///< different blocks may meet in measurements
  bool measurements = false;  ///< the measurements or the set of empty blocks may differ

  /// Returns whether anything differs.
  bool any() const { return blocks || meetings || measurements; }
  /// Adds further changes.
  void add(const StructureChanges& more) {
    blocks = blocks || more.blocks;
    meetings = meetings || more.meetings;
    measurements = measurements || more.measurements;
  }
  /// Returns all changes, for a problem seen for the first time.
  static StructureChanges all() { return {true, true, true}; }
};

/// The structure of a problem. A block has the index of its variable in the problem's table as long as the variable
/// exists. Blocks of fixed and removed variables are empty. Components that are fixed or at an active bound keep their
/// place among the unknowns. Their columns of J are 0. An extra group after the groups of the pools lists the
/// components that do not move. It has one "measurement" for each variable with fixed components or bounds.
struct ProblemStructure {
  BlockStructure system;
  int pools = 0;      ///< number of groups that come from pools
  int residuals = 0;  ///< sum of the lengths of all residuals

  /// Returns the first unknown of a variable.
  int offsetOf(int variable) const { return system.offset[static_cast<std::size_t>(variable)]; }
  bool operator==(const ProblemStructure&) const = default;
};

/// Returns the structure of a problem, computed from scratch.
ProblemStructure makeStructure(const Problem& problem);

/// Updates the structure that the problem had before some changes. Returns which parts of it differ. Takes time
/// proportional to the changes, and one addition for each block after the first one whose size has changed.
StructureChanges updateStructure(const Problem& problem, std::span<const Change> changes,
                                 ProblemStructure& structure);

}  // namespace slom
