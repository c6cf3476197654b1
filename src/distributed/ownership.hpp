/// Ownership of the variables that several processes have, and sums over all that have one.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "slom/distributed/petsc_solver.hpp"
#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// Who owns which block of unknowns. A block that one process has belongs to it; a shared block belongs to one of the
/// processes that have measurements of it.
class Ownership {
 public:
  /// Asks all processes. Throws [slom.bad-share] in all.
  void find(const Processes& processes, const Problem& problem, const BlockStructure& structure,
            const SharedVariables& shared);

  /// Returns whether the block belongs to this process.
  bool isOwn(int block) const { return owner_.empty() || owner_[static_cast<std::size_t>(block)] < 0; }
  /// Returns, by block, whether several processes may have it.
  const std::vector<char>& isShared() const { return is_shared_; }

  /// Adds, for each block of numbers, those of all processes that have the block, in their order. Every process gets
  /// the sums. `per_unknown`: vectors with an entry for each unknown.
  void addUp(const Processes& processes, const std::vector<Eigen::VectorXd*>& per_unknown) const;
  /// Does the same, but only the owner of a block gets the sums.
  void addUpAtOwners(const Processes& processes, const std::vector<Eigen::VectorXd*>& per_unknown) const;
  /// Gives own entries to the processes that have the block, too.
  void spread(const Processes& processes, Eigen::VectorXd& per_unknown) const;
  /// Sends a number of each block from its owner to all that have the block. `of_block` has an entry for each block.
  void spread(const Processes& processes, std::vector<std::int64_t>& of_block) const;

 private:
  std::vector<int> owner_;                                    // by block: -1 for this process
  std::vector<char> is_shared_;                               // by block
  std::vector<std::vector<int>> held_;                        // by process: its blocks that this process has
  std::vector<std::vector<int>> served_;                      // by process: own blocks that it has
  std::vector<std::size_t> held_unknowns_, served_unknowns_;  // by process: the unknowns of these blocks
  std::vector<int> offset_;                                   // first unknown of each block
};

}  // namespace slom::distributed
